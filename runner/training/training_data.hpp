// What a training reads of its data sets: examples to learn from, examples to judge by, and simulations to solve.
// Scales are those of the training examples alone. The same on every rank.
#pragma once

#include <string>
#include <vector>

#include "network/encoding/feature_encoder.hpp"
#include "network/encoding/stored_simulation.hpp"
#include "network/training/example.hpp"
#include "runner/training/learning_sets.hpp"

namespace rodsweep {

struct TrainingData {
  std::vector<Example> training, validation;  ///< normalised
  FeatureScales scales;
  std::int64_t training_simulations = 0, validation_simulations = 0;
  std::vector<std::string> validation_scenes;  ///< the type of each validation simulation's scene
  std::string hash;                            ///< of the data sets
  std::string note;                            ///< what is to be said about it; empty: nothing
};

/// Throws FileError where there are too few examples.
TrainingData training_data(const TrainingJob& training, const LearningSets& sets, int threads);

/// The validation simulations on which CG ratios are measured: those whose number leaves `part` of `parts`.
std::vector<StoredSimulation> ratio_simulations(const TrainingJob& training, const LearningSets& sets, int part,
                                                int parts);

}  // namespace rodsweep
