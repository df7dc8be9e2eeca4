#include "runner/training/training_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "network/training/example_builder.hpp"
#include "network/training/threads.hpp"

namespace rodsweep {

DatasetReader open_dataset(const TrainingJob& training, const Job& job) {
  std::error_code error;
  if (!std::filesystem::exists(training.data, error)) {
    throw job_error(job.path, "data",
                    fmt::format("there is no file {}: make the data set first, with `rodsweep run` and a job of kind "
                                "\"dataset\"",
                                training.data.native()));
  }
  DatasetReader dataset(training.data);
  if (dataset.size() <= training.validation_simulations) {
    throw job_error(job.path, "validation_simulations",
                    fmt::format("{} is not allowed, since {} holds {} simulations and some must be left to learn from",
                                training.validation_simulations, training.data.native(), dataset.size()));
  }
  return dataset;
}

namespace {

/// The examples of simulations in their order, made by threads, a few simulations at a time.
void add_all(const CopingNetSettings& network, const DatasetReader& dataset, std::int64_t first, std::int64_t end,
             int threads, std::vector<Example>& out) {
  for (std::int64_t begin = first; begin < end; begin += threads) {
    const std::vector<StoredSimulation> simulations =
        dataset.read(begin, std::min<std::int64_t>(threads, end - begin));
    std::vector<std::vector<Example>> examples(simulations.size());
    in_parallel(static_cast<int>(simulations.size()), threads, [&](int i, int) {
      add_examples(network, simulations[static_cast<std::size_t>(i)], examples[static_cast<std::size_t>(i)]);
    });
    for (std::vector<Example>& of : examples) std::move(of.begin(), of.end(), std::back_inserter(out));
  }
}

}  // namespace

TrainingData training_data(const TrainingJob& training, const DatasetReader& dataset, int threads) {
  TrainingData data;
  data.hash = dataset.hash();
  data.note = dataset.note();
  data.validation_simulations = training.validation_simulations;
  data.training_simulations = dataset.size() - training.validation_simulations;
  for (std::int64_t i = data.training_simulations; i < dataset.size(); ++i)
    data.validation_scenes.emplace_back(
        std::visit([](const auto& scene) { return std::decay_t<decltype(scene)>::name; },
                   dataset.plan().spec(dataset.task(i).index).scene));
  add_all(training.network, dataset, 0, data.training_simulations, threads, data.training);
  add_all(training.network, dataset, data.training_simulations, dataset.size(), threads, data.validation);
  if (data.training.size() < static_cast<std::size_t>(training.training.batch) || data.validation.empty()) {
    throw FileError(fmt::format("{} gives {} examples for training and {} for validation: too few for batches of {}",
                                training.data.native(), data.training.size(), data.validation.size(),
                                training.training.batch));
  }
  data.scales = feature_scales(training.network, data.training);
  normalise(training.network, data.scales, data.training);
  normalise(training.network, data.scales, data.validation);
  return data;
}

std::vector<StoredSimulation> ratio_simulations(const TrainingJob& training, const DatasetReader& dataset, int part,
                                                int parts) {
  const std::int64_t count = std::min(training.ratio_simulations, training.validation_simulations);
  std::vector<StoredSimulation> out;
  for (std::int64_t i = part; i < count; i += parts)
    out.push_back(dataset.read(dataset.size() - training.validation_simulations + i));
  return out;
}

}  // namespace rodsweep
