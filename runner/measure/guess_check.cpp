#include "runner/measure/guess_check.hpp"

#include <fmt/format.h>

#include "runner/measure/models.hpp"
#include "runner/text/key_path.hpp"

namespace rodsweep {
namespace {

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

/// Throws JobError unless the model's encoding is for states (`of_states`) or for linear systems.
void check_model(const Plan& plan, const std::string& key, const std::filesystem::path& model, bool of_states) {
  if (is_guess(shared_model(model)->net.settings()) != of_states) return;
  const std::string name = model.filename().string();
  throw job_error(plan.job().path, key,
                  of_states ? fmt::format("{} is not allowed: its encoding is not \"state\"; must be a model with "
                                          "encoding \"state\", or use solve.method \"end_to_end\"",
                                          name)
                            : fmt::format("{} is not allowed: its encoding is \"state\"; must be a model with another "
                                          "encoding, or use solve.method \"state_network\"",
                                          name));
}

/// A rod along one arc length has neither loops nor branches.
void check_knn(const Plan& plan, const Task& task, const TaskSpec& spec, const std::string& key) {
  const bool loops = task.joints > task.segments - rod_count(spec.scene);
  if (!loops && !branches(spec.scene)) return;
  throw job_error(
      plan.job().path, key,
      fmt::format(
          "\"knn\" is not allowed on rods {} (the joints of the {} segments of task {} {}); must be another guess",
          loops ? "with loops" : "with branches", task.segments, task.index, loops ? "close a loop" : "form a tree"));
}

void check_copingnet(const Plan& plan, const guess::CopingNet& guess, const std::string& key) {
  check_model(plan, key, guess.model, false);
  const char* for_factors = guess.corrections > 1 ? "corrections above 1"
                            : guess.lag_steps > 0 ? "lag_steps"
                            : guess.stop_at > 0   ? "stop_at"
                                                  : nullptr;
  if (for_factors && shared_model(guess.model)->net.settings().processor != Processor::factors)
    throw job_error(plan.job().path, key,
                    fmt::format("{} is not allowed with {}, a network without factors", for_factors,
                                guess.model.filename().string()));
}

void check_learned(const Plan& plan, const std::filesystem::path& model) {
  if (shared_model(model)->net.settings().processor != Processor::factors)
    throw job_error(plan.job().path, "solve.learned_preconditioner.model",
                    model.filename().string() +
                        " is not allowed: its network has no factors; must be a model with the "
                        "processor \"factors\"");
}

void check(const Plan& plan, const Task& task, const TaskSpec& spec) {
  if (spec.solve.preconditioner == Preconditioner::learned) check_learned(plan, spec.solve.learned->model);
  if (is_network(spec.solve.method))
    check_model(plan, "solve.model", spec.solve.model, spec.solve.method == Method::state_network);
  for (std::size_t i = 0; i < spec.guesses.size(); ++i) {
    const std::string key = element("guesses", i);
    if (find_guess<guess::Knn>(spec.guesses[i])) check_knn(plan, task, spec, key);
    if (const auto* learned = find_guess<guess::CopingNet>(spec.guesses[i])) check_copingnet(plan, *learned, key);
  }
}

}  // namespace

void check_guesses(const Plan& plan) {
  if (plan.job().files.empty()) return;  // no models or data sets to check
  for (const Task& task : plan.tasks()) check(plan, task, plan.spec(task.index));
}

}  // namespace rodsweep
