#include "runner/training/training_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "network/training/example_builder.hpp"
#include "network/training/threads.hpp"

namespace rodsweep {

/// The examples of these simulations, in order; not normalised. Processes a few simulations at a time.
static std::vector<Example> examples_of(const TrainingJob& training,
                                        const std::vector<LearningSets::Simulation>& simulations, int threads,
                                        const Copies& copies = {}) {
  std::vector<Example> out;
  for (std::size_t begin = 0; begin < simulations.size(); begin += static_cast<std::size_t>(threads)) {
    std::vector<StoredSimulation> read_now;  // by one thread: HDF5 is not thread-safe
    for (std::size_t i = begin; i < std::min(begin + static_cast<std::size_t>(threads), simulations.size()); ++i)
      read_now.push_back(read(simulations[i]));
    std::vector<std::vector<Example>> examples(read_now.size());
    in_parallel(static_cast<int>(read_now.size()), threads, [&](int i, int) {
      add_examples(training.network, read_now[static_cast<std::size_t>(i)], examples[static_cast<std::size_t>(i)],
                   {copies.count, copies.noise, split_mix(copies.seed + begin + static_cast<std::size_t>(i))},
                   training.first_iterations_only);
    });
    for (std::vector<Example>& of : examples) std::move(of.begin(), of.end(), std::back_inserter(out));
  }
  return out;
}

TrainingData training_data(const TrainingJob& training, const LearningSets& sets, int threads) {
  TrainingData data;
  data.hash = sets.hash();
  data.note = sets.note();
  data.validation_simulations = static_cast<std::int64_t>(sets.validation().size());
  data.training_simulations = static_cast<std::int64_t>(sets.training().size());
  for (const LearningSets::Simulation& simulation : sets.validation())
    data.validation_scenes.push_back(scene_of(simulation));
  data.training = examples_of(training, sets.training(), threads, training.copies());
  data.validation = examples_of(training, sets.validation(), threads);
  if (data.training.size() < static_cast<std::size_t>(training.training.batch) || data.validation.empty()) {
    throw FileError(fmt::format("{} gives {} examples for training and {} for validation: too few for batches of {}",
                                paths_of(training.data), data.training.size(), data.validation.size(),
                                training.training.batch));
  }
  data.scales = feature_scales(training.network, data.training);
  normalise(training.network, data.scales, data.training);
  normalise(training.network, data.scales, data.validation);
  return data;
}

std::vector<StoredSimulation> ratio_simulations(const TrainingJob& training, const LearningSets& sets, int part,
                                                int parts) {
  const auto all = static_cast<std::int64_t>(sets.validation().size());
  std::vector<StoredSimulation> out;
  for (std::int64_t i = 0; i < std::min(training.ratio_simulations, all); ++i) {
    StoredSimulation simulation = read(sets.validation()[static_cast<std::size_t>(i)]);
    if (i % parts == part) out.push_back(std::move(simulation));
  }
  return out;
}

}  // namespace rodsweep
