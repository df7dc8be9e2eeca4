#include "runner/measure/plan_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>
#include <vector>

#include "runner/dataset/dataset_reader.hpp"
#include "runner/file/file_error.hpp"
#include "runner/file/task_reader.hpp"
#include "runner/measure/shared_inputs.hpp"
#include "runner/measure/start_state.hpp"
#include "runner/text/job_error.hpp"
#include "solver/factor/block_factor.hpp"
#include "solver/linear/linear_system.hpp"

namespace rodsweep {
namespace {

/// Executes a file of Python; does nothing with another.
void open_python(const std::filesystem::path& path, FileKind kind) {
  if (kind == FileKind::python_guess) PluginInstance(plugin_source({path, ""}, PythonClass::guess), nullptr, 0);
  if (kind == FileKind::python_preconditioner)
    PluginInstance(plugin_source({path, ""}, PythonClass::preconditioner), nullptr, 0);
}

void open_input(const std::filesystem::path& path, FileKind kind) {
  switch (kind) {
    case FileKind::any: return;
    case FileKind::model: shared_model(path); return;
    case FileKind::data_set: DatasetReader{path}; return;
    case FileKind::results: TaskReader{path}; return;
    case FileKind::skeleton:
    case FileKind::curves: return;  // the plan reads these
    case FileKind::plugin: Plugin(plugin_source({path, ""})); return;
    case FileKind::python_guess:
    case FileKind::python_preconditioner: open_python(path, kind); return;
  }
}

bool branches(const SceneSpec& scene) {
  if (open_rod(scene)) return false;
  for (const Rod& rod : build_scene(scene).rods)
    for (const std::vector<JointEnd>& joints : joints_by_segment(rod))
      if (joints.size() > 2) return true;
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

      "\"knn\" is not allowed on rods {} (the joints of the {} segments of task {} {}); must be another guess",
      loops ? "with loops" : "with branches", task.segments, task.index, loops ? "close a loop" : "form a tree");
}

void check_copingnet(const Plan& plan, const guess::CopingNet& guess, const std::string& key) {
  check_model(plan, key, guess.model, false);
  const char* for_factors = guess.corrections > 1 ? "corrections above 1"
                            : guess.lag_steps > 0 ? "lag_steps"
                            : guess.stop_at > 0   ? "stop_at"
                                                  : nullptr;
  if (for_factors && shared_model(guess.model)->net.settings().processor != Processor::factors)
    throw job_error(plan.job().path, key, "{} is not allowed with {}, a network without factors", for_factors,
                    guess.model.filename().string());
}

void check_learned(const Plan& plan, const std::filesystem::path& model) {
  if (shared_model(model)->net.settings().processor != Processor::factors)
    throw job_error(plan.job().path, "solve.learned_preconditioner.model",
                    model.filename().string() +
                        " is not allowed: its network has no factors; must be a model with the processor \"factors\"");
}

/// Of the first sample of each point.
void check_start(const Plan& plan, const Task& task, const TaskSpec& spec) {
  if (!spec.start || task.sample > 0) return;
  try {
    Scene scene = build_scene(spec.scene);
    StartState(*spec.start, scene);
  } catch (const FileError& error) {
    throw job_error(plan.job().path, "start.file", error.what());
  }
}

void check(const Plan& plan, const Task& task, const TaskSpec& spec) {
  check_start(plan, task, spec);
  if (spec.solve.preconditioner == Preconditioner::learned) check_learned(plan, spec.solve.learned->model);
  if (is_network(spec.solve.method))
    check_model(plan, "solve.model", spec.solve.model, spec.solve.method == Method::state_network);
  for (std::size_t i = 0; i < spec.guesses.size(); ++i) {
    const std::string key = element("guesses", i);
    if (find_guess<guess::Knn>(spec.guesses[i])) check_knn(plan, task, spec, key);
    if (const auto* learned = find_guess<guess::CopingNet>(spec.guesses[i])) check_copingnet(plan, *learned, key);
  }
}

bool is_oracle(const GuessSpec& guess) { return find_guess<guess::Oracle>(guess) != nullptr; }

/// The key that makes a task factorise, and the alternative; null if it does not factorise.
struct Need {
  const char *for_what, *instead;
};
Need need(const TaskSpec& spec) {
  if (spec.solves_directly())
    return {"solve", "a smaller scene, or method \"cg\" with \"reference\": \"cg\" (no factorisation)"};
  if (rod_parameters(spec.scene).contact) return {"scene.contact", "a smaller scene, or one without contact"};
  if (std::any_of(spec.guesses.begin(), spec.guesses.end(), is_oracle))
    return {"guesses", "a smaller scene, or no \"oracle\""};
  return {nullptr, nullptr};
}

/// Whether a factor with all 6 x 6 blocks of its lower triangle might be too large.
bool may_be_too_large(std::int64_t joints, double most_bytes) {
  const auto n = static_cast<double>(joints);
  return sizeof(double) * 36 * n * n / 2 > most_bytes / 2;  // fronts are padded
}

/// Throws JobError if the joints of one segment are too many: each is coupled to each, in the matrix and in its factor.
void check_couplings(const Rod& rod, const Task& task, const Job& job, double most_bytes) {
  const std::vector<std::vector<JointEnd>> joints = joints_by_segment(rod);
  double most = 0;
  for (std::size_t s = 0; s < joints.size(); ++s)
    if (!rod.segments[s].is_static) most = std::max(most, static_cast<double>(joints[s].size()));
  constexpr double gibibyte = 1 << 30;
  if (const double bytes = sizeof(double) * 36 * most * most; bytes > most_bytes)
    throw job_error(job.path, "scene",
                    "task {}: {} joints on one segment need {:.3g} GiB, because each is coupled to each; must be at "
                    "most {:.3g} GiB: hold the point where they meet, or let fewer meet there",
                    task.index, most, bytes / gibibyte, most_bytes / gibibyte);
}

}  // namespace

void check_inputs(const Job& job) {
  for (const auto& [written, file] : job.files) {
    if (file.hash.empty()) continue;
    for (const auto& [key_path, kind] : file.uses) {
      try {
        open_input(file.path, kind);
      } catch (const FileError& error) {
        throw job_error(job.path, key_path, error.what());
      } catch (const PluginError& error) {
        throw job_error(job.path, key_path, error.what());
      }
    }
  }
}

void load_python(const Job& job) {
  for (const auto& [written, file] : job.files)
    for (const FileUse& use : file.uses) open_python(file.path, use.kind);
}

Plan checked_plan(const Job& job) {
  Plan plan(job);
  check_guesses(plan);
  check_factors(plan);
  return plan;
}

void check_guesses(const Plan& plan) {
  if (plan.job().files.empty()) return;  // no models or data sets to check
  for (const Task& task : plan.tasks()) check(plan, task, plan.spec(task.index));
}

void check_factors(const Plan& plan, double most_bytes) {
  std::set<std::tuple<std::size_t, std::int64_t, std::int64_t, bool>> seen;
  for (const Task& task : plan.tasks()) {
    if (!may_be_too_large(task.joints, most_bytes)) continue;
    const TaskSpec spec = plan.spec(task.index);
    const Need factor = need(spec);
    const bool loops = task.joints > task.segments - rod_count(spec.scene), factorises = loops && factor.for_what;
    if (is_gauss_seidel(spec.solve.method) ||
        !seen.emplace(spec.scene.index(), task.segments, task.joints, factorises).second)
      continue;
    for (const Rod& rod : build_scene(spec.scene).rods) {
      if (!may_be_too_large(rod.joint_count(), most_bytes)) continue;
      check_couplings(rod, task, plan.job(), most_bytes);
      if (!factorises) continue;
      try {
        refuse_too_large(plan_elimination(LinearSystem(rod).matrix(), root_to_leaf_order(rod)), most_bytes);
      } catch (const FactorTooLarge& error) {
        throw job_error(plan.job().path, factor.for_what, "task {}: {}; must be {}", task.index, error.what(),
                        factor.instead);
      }
    }
  }
}

}  // namespace rodsweep
