#include "runner/command/training_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "network/guess/coping_net_guess.hpp"
#include "network/training/threads.hpp"
#include "runner/command/next_line.hpp"
#include "runner/terminal/text.hpp"
#include "runner/training/training_data.hpp"
#include "runner/training/validation_ratio.hpp"
#include "solver/step/stopwatch.hpp"

namespace rodsweep {
namespace {

constexpr std::int64_t fewest_simulations = 8, all_systems = 20'000;  // all simulations of a small data set are tried
constexpr double probed_s = 0.5;

/// Sizes of a training. Before a probe the numbers of examples and steps are upper bounds: a system whose base guess is
/// exact gives no example, and later Newton iterations may be left out.
struct Extent {
  std::size_t parameters = 0;
  std::int64_t training_simulations = 0, validation_simulations = 0;
  std::int64_t training_examples = 0, validation_examples = 0;
  std::int64_t steps_per_epoch = 0, steps = 0;
};

/// Result of a probe. Seconds on one core. Reading is repeated by every rank; the rest is shared.
struct Probe {
  double bytes = 0;         ///< of all examples
  double reading_s = 0;     ///< of all data, on each rank
  double training_s = 0;    ///< of all steps
  double validation_s = 0;  ///< of all losses and CG ratios
  bool counted = false;     ///< all simulations were tried: the numbers of examples are exact
};

void set_steps(Extent& extent, const TrainingJob& job) {
  extent.steps_per_epoch = extent.training_examples / job.training.batch;
  extent.steps = extent.steps_per_epoch * job.training.epochs;
}

Extent extent_of(const TrainingJob& job, const LearningSets& sets) {
  Extent extent;
  extent.parameters = CopingNet<float>(job.network, 0).parameters().values().size();
  extent.training_simulations = static_cast<std::int64_t>(sets.training().size());
  extent.validation_simulations = static_cast<std::int64_t>(sets.validation().size());
  for (const LearningSets::Simulation& simulation : sets.training())
    extent.training_examples += (1 + job.copies().count) * systems_of(simulation);
  for (const LearningSets::Simulation& simulation : sets.validation())
    extent.validation_examples += systems_of(simulation);
  set_steps(extent, job);
  return extent;
}

double bytes_of(const Example& example) {
  const ScaledSystem<float>& system = example.system;
  Eigen::Index floats = 0;
  for (const Tensor<float>* part : {&example.nodes, &example.edges, &example.unit, &example.edge_target,
                                    &example.node_target, &system.diagonal, &system.coupling, &system.residual})
    floats += part->size();
  return static_cast<double>(floats) * sizeof(float) +
         static_cast<double>(system.couplings.size() * sizeof(SystemPattern::Coupling) + sizeof(Example));
}

double seconds_of_ratio(const TrainingJob& job, const Model& model, StoredSimulation simulation,
                        std::int64_t simulations) {
  if (!is_guess(job.network)) return 0;
  const ValidationRatio ratio({std::move(simulation)});
  const auto shared = std::make_shared<const Model>(model);
  const Stopwatch watch;
  ratio.measure(0, [&](const Scene& scene, const StoredSimulation& of) {
    return std::make_unique<CopingNetGuess>(shared, scene, of.newton_iterations);
  });
  const int times = 1 + (job.ratio_every_epochs > 0 ? job.training.epochs / job.ratio_every_epochs : 0);
  return watch.seconds() * times * static_cast<double>(std::min(job.ratio_simulations, simulations));
}

/// Seconds per step of the optimiser.
double seconds_of_step(Trainer& trainer, int shard_count) {
  std::vector<std::vector<float>> shards(static_cast<std::size_t>(shard_count),
                                         std::vector<float>(trainer.shard_size()));
  std::vector<const float*> gradients;
  std::vector<Trainer::Shard> parts;
  for (std::vector<float>& shard : shards) {
    parts.push_back({static_cast<int>(parts.size()), shard.data()});
    gradients.push_back(shard.data());
  }
  int steps = -1;  // the first step is not timed: it allocates memory
  Stopwatch watch;
  for (; steps < 3 || watch.seconds() < probed_s; ++steps) {
    if (steps == 0) watch = Stopwatch();
    trainer.compute(parts);
    trainer.update(gradients);
  }
  return watch.seconds() / steps;
}

/// Trains for a moment. Replaces the upper bounds of `extent` by the numbers found.
Probe probe(const TrainingJob& job, const LearningSets& sets, Extent& extent) {
  Probe probe;
  const std::int64_t all = extent.training_simulations;
  const std::int64_t for_a_batch = 1 + job.training.batch * all / std::max<std::int64_t>(extent.training_examples, 1);
  probe.counted = extent.training_examples + extent.validation_examples <= all_systems;
  const std::int64_t tried = probe.counted ? all : std::min(all, std::max(fewest_simulations, for_a_batch));
  std::vector<LearningSets::Simulation> simulations;
  std::int64_t systems = 0;
  for (std::int64_t i = 0; i < tried; ++i) {
    simulations.push_back(sets.training()[static_cast<std::size_t>(i * all / tried)]);
    systems += (1 + job.copies().count) * systems_of(simulations.back());
  }
  const Stopwatch reading;
  std::vector<Example> examples = examples_of(job, simulations, 1, job.copies());
  const double share = static_cast<double>(all + extent.validation_simulations) / static_cast<double>(tried);
  probe.reading_s = share * reading.seconds();
  for (const Example& example : examples) probe.bytes += share * bytes_of(example);
  const double learned = static_cast<double>(examples.size()) / static_cast<double>(systems);
  const auto part_of = [&](std::int64_t count) { return std::llround(learned * static_cast<double>(count)); };
  extent.training_examples = part_of(extent.training_examples);
  extent.validation_examples = probe.counted ? static_cast<std::int64_t>(examples_of(job, sets.validation(), 1).size())
                                             : part_of(extent.validation_examples);
  set_steps(extent, job);
  if (static_cast<int>(examples.size()) < job.training.batch)
    throw FileError(fmt::format("{} has too few examples for a batch of {}", paths_of(job.data), job.training.batch));

  Model model{CopingNet<float>(job.network, job.training.seed), feature_scales(job.network, examples)};
  normalise(job.network, model.scales, examples);
  Trainer trainer(model.net, examples, job.training);
  probe.training_s = seconds_of_step(trainer, job.training.shards) * static_cast<double>(extent.steps);
  const Stopwatch forward;
  const auto judged = trainer.losses(examples, [](int batch) { return batch < 3; }).size();
  probe.validation_s = forward.seconds() / (std::min<double>(3, static_cast<double>(judged)) * job.training.batch) *
                       static_cast<double>(extent.validation_examples) * job.training.epochs;
  probe.validation_s += seconds_of_ratio(job, model, read(sets.validation().front()), extent.validation_simulations);
  return probe;
}

const char* accuracy(const std::optional<Probe>& probe) { return !probe ? "at most " : probe->counted ? "" : "about "; }

nlohmann::ordered_json to_json(const Job& job, const TrainingJob& training, const Extent& extent,
                               const std::optional<Probe>& probe) {
  nlohmann::ordered_json json{{"job", job.path.native()},
                              {"name", job.name},
                              {"data", paths_of(training.data)},
                              {"parameters", extent.parameters},
                              {"training_simulations", extent.training_simulations},
                              {"validation_simulations", extent.validation_simulations},
                              {"counts_are", probe ? probe->counted ? "exact" : "estimates" : "upper bounds"},
                              {"training_examples", extent.training_examples},
                              {"validation_examples", extent.validation_examples},
                              {"epochs", training.training.epochs},
                              {"steps", extent.steps}};
  if (!probe) return json;
  json["bytes_per_rank"] = probe->bytes;
  json["core_hours"] = (probe->reading_s + probe->training_s + probe->validation_s) / 3600;
  return json;
}

std::string to_text(const PlanOptions& options, const Job& job, const TrainingJob& training, const Extent& extent,
                    const std::optional<Probe>& probe) {
  const int threads = std::min(available_threads(), training.training.shards);
  RunOptions run;
  run.job = options.job;
  run.program = options.program;
  std::string text = fmt::format("job       {} ({})\n", job.name, job.path.native());
  text += fmt::format("data      {}\n", paths_of(training.data));
  text += fmt::format("examples  {}{} from {} simulations for training, {} from {} for validation\n", accuracy(probe),
                      extent.training_examples, extent.training_simulations, extent.validation_examples,
                      extent.validation_simulations);
  text += fmt::format("network   {} parameters\n", extent.parameters);
  text += fmt::format("steps     {}{}: {} in each of {} epochs\n", accuracy(probe), extent.steps,
                      extent.steps_per_epoch, training.training.epochs);
  if (probe) {
    const double seconds = probe->reading_s + (probe->training_s + probe->validation_s) / threads;
    text += fmt::format("memory    about {} per rank\n", bytes_text(static_cast<std::int64_t>(probe->bytes)));
    text += fmt::format("time      about {} on {} here\n", duration_text(seconds), counted(threads, "core"));
  }
  return text + "next      " + run_line(run, 1);
}

}  // namespace

ExitCode show_training_plan(const PlanOptions& options, const Job& job, Console& console) {
  const TrainingJob training = training_job(job);
  const LearningSets sets(training, job);
  Extent extent = extent_of(training, sets);
  std::optional<Probe> probed;
  if (options.probe) probed = probe(training, sets, extent);
  console.result(options.json ? json_text(to_json(job, training, extent, probed))
                              : to_text(options, job, training, extent, probed));
  return ExitCode::ok;
}

}  // namespace rodsweep
