// The data sets of a training, split into training and validation simulations.
//
// The last `validation_simulations` of each set are for validation, interleaved so that the first few include all sets.
// The first `training_simulations` of each set, or all others if 0, are for training, in the order of the sets.
#pragma once

#include <string>
#include <vector>

#include "network/encoding/feature_encoder.hpp"
#include "network/encoding/stored_simulation.hpp"
#include "network/training/example.hpp"
#include "runner/dataset/dataset_reader.hpp"
#include "runner/specs/training_job.hpp"

namespace rodsweep {

class LearningSets {
 public:
  struct Simulation {
    const DatasetReader* set;
    std::int64_t number;
  };

  /// Throws JobError if a set is missing or too small, FileError if a set is invalid. `ranks`: read the sets
  /// collectively (runner/dataset/dataset_reader.hpp).
  LearningSets(const TrainingJob& training, const Job& job, std::optional<MPI_Comm> ranks = std::nullopt);
  LearningSets(const LearningSets&) = delete;
  LearningSets& operator=(const LearningSets&) = delete;

  const std::vector<Simulation>& training() const { return training_; }
  const std::vector<Simulation>& validation() const { return validation_; }

  /// A hash of the data: sixteen hexadecimal digits.
  const std::string& hash() const { return hash_; }
  /// A text about failed simulations, which are left out; empty if none failed.
  const std::string& note() const { return note_; }

 private:
  std::vector<DatasetReader> sets_;
  std::vector<Simulation> training_, validation_;
  std::string hash_, note_;
};

inline StoredSimulation read(const LearningSets::Simulation& simulation) {
  return simulation.set->read(simulation.number);
}
/// The type of the simulation's scene.
std::string scene_of(const LearningSets::Simulation& simulation);
/// The number of stored linear systems.
std::int64_t systems_of(const LearningSets::Simulation& simulation);

/// The paths, joined for messages.
std::string paths_of(const std::vector<std::filesystem::path>& sets);

/// The data of a training: training examples, validation examples, and simulations to measure CG ratios.
/// Scales come from the training examples only. The examples are the same on every rank.
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
