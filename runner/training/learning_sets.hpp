// The data sets of a training: which simulations are learned from and which are judged by.
//
// The last `validation_simulations` of every set are for validation, in turns of one of each set, so that the first few
// have something of all; of the others, set by set, all or the first `training_simulations` are learned from.
#pragma once

#include <string>
#include <vector>

#include "runner/dataset/dataset_reader.hpp"
#include "runner/job/training_job.hpp"

namespace rodsweep {

class LearningSets {
 public:
  struct Simulation {
    const DatasetReader* set;
    std::int64_t number;
  };

  /// Throws JobError where a set is missing or too small, FileError for what is wrong with one. With ranks: of those
  /// that read the sets together (runner/dataset/dataset_reader.hpp).
  LearningSets(const TrainingJob& training, const Job& job, std::optional<MPI_Comm> ranks = std::nullopt);
  LearningSets(const LearningSets&) = delete;
  LearningSets& operator=(const LearningSets&) = delete;

  const std::vector<Simulation>& training() const { return training_; }
  const std::vector<Simulation>& validation() const { return validation_; }

  /// Sixteen hexadecimal digits: the same for the same data.
  const std::string& hash() const { return hash_; }
  /// Which simulations failed and are left out; empty: none.
  const std::string& note() const { return note_; }

 private:
  std::vector<DatasetReader> sets_;
  std::vector<Simulation> training_, validation_;
  std::string hash_, note_;
};

inline StoredSimulation read(const LearningSets::Simulation& simulation) {
  return simulation.set->read(simulation.number);
}
/// The type of its scene.
std::string scene_of(const LearningSets::Simulation& simulation);
/// How many linear systems it holds.
std::int64_t systems_of(const LearningSets::Simulation& simulation);

/// The paths as a text, for messages.
std::string paths_of(const std::vector<std::filesystem::path>& sets);

}  // namespace rodsweep
