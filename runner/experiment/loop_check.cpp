#include "runner/experiment/loop_check.hpp"

#include <fmt/format.h>

#include "network/graph/joint_forest.hpp"
#include "runner/experiment/models.hpp"
#include "runner/job/key_path.hpp"

namespace rodsweep {
namespace {

bool is_forest(const SceneSpec& scene) {
  try {
    for (const Rod& rod : build_scene(scene).rods) joint_forest(rod);
    return true;
  } catch (const SceneError&) {
    return false;
  }
}

bool branches(const SceneSpec& scene) {
  if (open_rod(scene)) return false;
  for (const Rod& rod : build_scene(scene).rods) {
    std::vector<int> joints(rod.segments.size(), 0);
    for (const Joint& joint : rod.joints)
      for (const int segment : {joint.a, joint.b})
        if (++joints[static_cast<std::size_t>(segment)] > 2) return true;
  }
  return false;
}

bool sweeps(const std::filesystem::path& model) {
  return shared_model(model)->net.settings().processor == Processor::sweeps;
}

void refuse(const Plan& plan, const Task& task, const std::string& path, const std::string& what,
            const char* joints = "close a loop") {
  throw job_error(
      plan.job().path, path,
      fmt::format("{}; the joints of the {} segments of task {} {}", what, task.segments, task.index, joints));
}

void check(const Plan& plan, const Task& task, const TaskSpec& spec) {
  constexpr const char* no_sweeps =
      "a network with \"sweeps\" is not allowed on rods with loops; must be one with \"message_passing\"";
  const bool may_loop = task.joints > task.segments - rod_count(spec.scene);
  if (may_loop && spec.solve.method == Method::end_to_end && sweeps(spec.solve.model) && !is_forest(spec.scene))
    refuse(plan, task, "solve.model", no_sweeps);
  for (std::size_t i = 0; i < spec.guesses.size(); ++i)
    for (const GuessSpec* guess = &spec.guesses[i]; guess;
         guess = guess->inner.empty() ? nullptr : &guess->inner.front()) {
      const bool knn = guess->kind == GuessSpec::Kind::knn;
      if (knn && may_loop)
        refuse(plan, task, element("guesses", i), "\"knn\" is not allowed on rods with loops; must be another guess");
      if (knn && branches(spec.scene))
        refuse(plan, task, element("guesses", i), "\"knn\" is not allowed on rods that branch; must be another guess",
               "form a tree");
      if (may_loop && guess->kind == GuessSpec::Kind::copingnet && sweeps(guess->model) && !is_forest(spec.scene))
        refuse(plan, task, element("guesses", i), no_sweeps);
    }
}

}  // namespace

void check_loops(const Plan& plan) {
  if (plan.job().files.empty()) return;  // no network, no data of neighbours
  for (const Task& task : plan.tasks()) check(plan, task, plan.spec(task.index));
}

}  // namespace rodsweep
