// A model file (HDF5): a trained network, where it comes from, how it was trained, and how well it does.
//
//   /               attributes program, schema_version, kind "model", title
//   /job, /runs     the job as given; one row per start of the training, as in a results file
//   /data           attributes: path and hash of the data set, its simulations and examples
//   /model          attribute hash; settings (the job's `network` as JSON), weights/NAME [rows, columns],
//                   scales/QUANTITY/mean and deviation where the encoding has any
//   /axes/tolerance, /training, /validation   losses, rate and CG ratios by epoch; the CG ratio of the model kept
//   /timing         seconds of every epoch
//   /checkpoint     only while the training has not ended: all that it takes to go on exactly
// The file is always whole: it is written anew under a temporary name and then takes the place of its earlier state.
// Throws FileError for what is missing, foreign, damaged or of another schema version; Hdf5Error.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "network/processor/model.hpp"
#include "runner/file/unfinished_file.hpp"
#include "runner/training/checkpoint.hpp"
#include "runner/training/model_card.hpp"

namespace rodsweep {

inline constexpr int model_schema_version = 1;

/// Sixteen hexadecimal digits over settings, weights and scales: the same for models that say the same.
std::string model_hash(const Model& model);

struct StoredModel {
  std::shared_ptr<Model> model;
  ModelCard card;
  std::optional<Checkpoint> checkpoint;
};

bool is_model_file(const std::filesystem::path& path);

/// A model to use. Refuses one that no epoch of training has ended of.
StoredModel read_model(const std::filesystem::path& path);
/// As it is, however far its training came.
StoredModel read_training(const std::filesystem::path& path);

/// The file of a training that runs.
class ModelFile {
 public:
  /// Creates nothing. `continues`: the file is there, and what it holds goes on.
  ModelFile(std::filesystem::path path, bool continues);

  /// The first one takes the name, and refuses a file that has it.
  void save(const ModelCard& card, const Model& model, const std::optional<Checkpoint>& checkpoint);

 private:
  std::filesystem::path path_;
  std::optional<FileIdentity> earlier_;
};

}  // namespace rodsweep
