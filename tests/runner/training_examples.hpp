// For tests of trainings: a toy job, its data set, and a training without files.
#pragma once

#include "runner/training/training.hpp"
#include "tests/runner/data_set_examples.hpp"

namespace rodsweep {

/// Eight short simulations of rods that differ.
Json toy_data_job();

/// The same of trees in the wind.
Json toy_tree_data_job();

/// Four epochs of three steps.
Json toy_train_job();

/// A job with its data, read once, and trainings of it in this process.
struct Toy {
  TemporaryFolder folder;
  Job job;
  TrainingJob training;
  TrainingData data;
  std::vector<StoredSimulation> simulations;

  explicit Toy(const Json& values = toy_train_job(), const Json& rods = toy_data_job());

  Training begin() const;
  Training run() const;  ///< to its end
  static void finish(Training& training);
};

}  // namespace rodsweep
