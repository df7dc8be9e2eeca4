// The data of a training: training examples, validation examples, and simulations to measure CG ratios.
// Scales come from the training examples only. The examples are the same on every rank.
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
  std::vector<std::string> validation_scenes;  ///< scene type of each validation simulation
  std::string hash;                            ///< of the data sets
  std::string note;                            ///< a warning for the user; may be empty
};

/// Throws FileError if there are too few examples.
TrainingData training_data(const TrainingJob& training, const LearningSets& sets, int threads);

/// The validation simulations i to measure CG ratios on, with i mod `parts` = `part`.
std::vector<StoredSimulation> ratio_simulations(const TrainingJob& training, const LearningSets& sets, int part,
                                                int parts);

}  // namespace rodsweep
