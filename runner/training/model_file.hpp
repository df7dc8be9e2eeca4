// A model file (HDF5): a trained network, with its provenance, training history and quality.
//
//   /               attributes program, schema_version, kind "model", title
//   /job, /runs     the job as given; one row per start of the training, as in a results file
//   /data           attributes: path and hash of the data set, its simulations and examples
//   /model          attribute hash; settings (the job's `network` as JSON), weights/NAME [rows, columns],
//                   scales/QUANTITY/mean and deviation if the encoding has scales
//   /axes/tolerance, /training, /validation   losses, rate and CG ratios by epoch; the CG ratio of the best model
//   /timing         seconds of each epoch
//   /checkpoint     only until the training ends: the state to resume it exactly
// The file is always complete: each save writes a temporary file, which then replaces the old one.
// Throws FileError if a file is missing, foreign, damaged or of another schema version; Hdf5Error.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "network/processor/model.hpp"
#include "network/training/trainer.hpp"
#include "runner/file/unfinished_file.hpp"
#include "runner/training/model_card.hpp"

namespace rodsweep {

inline constexpr int model_schema_version = 2;

/// A hash of settings, weights and scales: sixteen hexadecimal digits.
std::string model_hash(const Model& model);

/// The state needed to resume a training exactly, in addition to the best model and the finished epochs.
struct Checkpoint {
  AlignedVector<float> weights;
  Trainer::State optimiser;
  double epoch_loss = 0;     ///< sum of the losses of the current epoch's steps
  double epoch_seconds = 0;  ///< time spent on the current epoch
};

struct StoredModel {
  std::shared_ptr<Model> model;
  ModelCard card;
  std::optional<Checkpoint> checkpoint;
};

bool is_model_file(const std::filesystem::path& path);

/// Reads a model for use. Throws FileError if no epoch of its training has ended.
StoredModel read_model(const std::filesystem::path& path);
/// Reads a model at any stage of its training.
StoredModel read_training(const std::filesystem::path& path);

/// The file of a running training.
class ModelFile {
 public:
  /// Does not create the file. `continues`: the file exists and its training is resumed.
  ModelFile(std::filesystem::path path, bool continues);

  /// The first save of a new training creates the file, and fails if it exists.
  void save(const ModelCard& card, const Model& model, const std::optional<Checkpoint>& checkpoint);

 private:
  std::filesystem::path path_;
  std::optional<FileIdentity> earlier_;
};

}  // namespace rodsweep
