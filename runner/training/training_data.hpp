// What a training reads of its data set: examples to learn from, examples to judge by, and simulations to solve.
//
// Simulations are taken in the order of DatasetReader, the last `validation_simulations` for validation; scales are
// those of the training examples alone. The same on every rank.
#pragma once

#include <string>
#include <vector>

#include "network/encoding/feature_encoder.hpp"
#include "network/encoding/stored_simulation.hpp"
#include "network/training/example.hpp"
#include "runner/dataset/dataset_reader.hpp"
#include "runner/job/training_job.hpp"

namespace rodsweep {

struct TrainingData {
  std::vector<Example> training, validation;  ///< normalised
  FeatureScales scales;
  std::int64_t training_simulations = 0, validation_simulations = 0;
  std::vector<std::string> validation_scenes;  ///< the type of each validation simulation's scene
  std::string hash;                            ///< of the data set (DatasetReader)
  std::string note;                            ///< what is to be said about it; empty: nothing
};

/// Opens the data set of a job. Throws JobError where it is missing or too small, FileError for what is wrong with it.
DatasetReader open_dataset(const TrainingJob& training, const Job& job);

TrainingData training_data(const TrainingJob& training, const DatasetReader& dataset, int threads);

/// The validation simulations on which CG ratios are measured: those whose number leaves `part` of `parts`.
std::vector<StoredSimulation> ratio_simulations(const TrainingJob& training, const DatasetReader& dataset, int part,
                                                int parts);

}  // namespace rodsweep
