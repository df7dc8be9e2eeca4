#include "runner/command/training_plan.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "network/processor/coping_net.hpp"
#include "runner/command/next_command.hpp"
#include "runner/terminal/formats.hpp"
#include "runner/training/learning_sets.hpp"

namespace rodsweep {
namespace {

/// Sizes of a training. The numbers of examples and steps are upper bounds: a system whose base guess is exact gives no
/// example, and later Newton iterations may be left out.
struct Extent {
  std::size_t parameters = 0;
  std::int64_t training_simulations = 0, validation_simulations = 0;
  std::int64_t training_examples = 0, validation_examples = 0;
  std::int64_t steps_per_epoch = 0, steps = 0;
};

Extent extent_of(const TrainingJob& job, const LearningSets& sets) {
  Extent extent;
  extent.parameters = CopingNet<float>(job.network, 0).parameters().values().size();
  extent.training_simulations = static_cast<std::int64_t>(sets.training().size());
  extent.validation_simulations = static_cast<std::int64_t>(sets.validation().size());
  for (const LearningSets::Simulation& simulation : sets.training())
    extent.training_examples += (1 + job.copies().count) * systems_of(simulation);
  for (const LearningSets::Simulation& simulation : sets.validation())
    extent.validation_examples += systems_of(simulation);
  extent.steps_per_epoch = extent.training_examples / job.training.batch;
  extent.steps = extent.steps_per_epoch * job.training.epochs;
  return extent;
}

nlohmann::ordered_json to_json(const Job& job, const TrainingJob& training, const Extent& extent) {
  return {{"job", job.path.native()},
          {"name", job.name},
          {"data", paths_of(training.data)},
          {"parameters", extent.parameters},
          {"training_simulations", extent.training_simulations},
          {"validation_simulations", extent.validation_simulations},
          {"most_training_examples", extent.training_examples},
          {"most_validation_examples", extent.validation_examples},
          {"epochs", training.training.epochs},
          {"most_steps", extent.steps}};
}

std::string to_text(const PlanOptions& options, const Job& job, const TrainingJob& training, const Extent& extent) {
  RunOptions run;
  run.job = options.job;
  run.program = options.program;
  return fmt::format(
      "job       {} ({})\n"
      "data      {}\n"
      "examples  at most {} from {} simulations for training, {} from {} for validation\n"
      "network   {} parameters\n"
      "steps     at most {}: {} in each of {} epochs\n"
      "next      {}",
      job.name, job.path.native(), paths_of(training.data), extent.training_examples, extent.training_simulations,
      extent.validation_examples, extent.validation_simulations, extent.parameters, extent.steps,
      extent.steps_per_epoch, training.training.epochs, run_line(run, 1));
}

}  // namespace

ExitCode show_training_plan(const PlanOptions& options, const Job& job, Console& console) {
  const TrainingJob training = training_job(job.values, job.path);
  const Extent extent = extent_of(training, LearningSets(training, job));
  console.result(options.json ? json_text(to_json(job, training, extent)) : to_text(options, job, training, extent));
  return ExitCode::ok;
}

}  // namespace rodsweep
