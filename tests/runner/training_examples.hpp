// For tests of training: a small job, its data set, and training without model files.
#pragma once

#include "runner/training/training.hpp"
#include "tests/runner/data_set_examples.hpp"

namespace rodsweep {

/// Eight short simulations of random rods.
Json toy_data_job();

/// Eight short simulations of random trees in the wind.
Json toy_tree_data_job();

/// Four epochs of three steps.
Json toy_train_job();

/// A training job and its data, which are read once. Each begin() starts a training in this process.
struct Toy {
  TemporaryFolder folder;
  Job job;
  TrainingJob training;
  TrainingData data;
  std::vector<StoredSimulation> simulations;

  explicit Toy(const Json& values = toy_train_job(), const Json& rods = toy_data_job());

  Training begin() const;
  Training run() const;  ///< begin() and finish()
  static void finish(Training& training);
};

}  // namespace rodsweep
