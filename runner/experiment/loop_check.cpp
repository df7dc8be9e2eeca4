#include "runner/experiment/loop_check.hpp"

#include <fmt/format.h>

#include "network/joint_forest.hpp"
#include "runner/experiment/models.hpp"
#include "runner/job/key_path.hpp"

namespace rodsweep {
namespace {

bool is_forest(const SceneSpec& scene) {
  try {
    joint_forest(build_scene(scene).rods.front());
    return true;
  } catch (const SceneError&) {
    return false;
  }
}

bool sweeps(const std::filesystem::path& model) {
  return shared_model(model)->net.settings().processor == Processor::sweeps;
}

void refuse(const Plan& plan, const Task& task, const std::string& path, const std::string& what) {
  throw job_error(
      plan.job().path, path,
      fmt::format("{}; the joints of the {} segments of task {} close a loop", what, task.segments, task.index));
}

void check(const Plan& plan, const Task& task, const TaskSpec& spec) {
  constexpr const char* no_sweeps =
      "a network with \"sweeps\" is not allowed on rods with loops; must be one with \"message_passing\"";
  if (spec.solve.method == Method::end_to_end && sweeps(spec.solve.model) && !is_forest(spec.scene))
    refuse(plan, task, "solve.model", no_sweeps);
  for (std::size_t i = 0; i < spec.guesses.size(); ++i)
    for (const GuessSpec* guess = &spec.guesses[i]; guess;
         guess = guess->inner.empty() ? nullptr : &guess->inner.front()) {
      if (guess->kind == GuessSpec::Kind::knn)
        refuse(plan, task, element("guesses", i), "\"knn\" is not allowed on rods with loops; must be another guess");
      if (guess->kind == GuessSpec::Kind::copingnet && sweeps(guess->model) && !is_forest(spec.scene))
        refuse(plan, task, element("guesses", i), no_sweeps);
    }
}

}  // namespace

void check_loops(const Plan& plan) {
  for (const Task& task : plan.tasks())
    if (task.joints >= task.segments) check(plan, task, plan.spec(task.index));
}

}  // namespace rodsweep
