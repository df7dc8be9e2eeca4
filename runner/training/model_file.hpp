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

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "network/processor/model.hpp"
#include "network/training/trainer.hpp"
#include "runner/file/provenance.hpp"
#include "runner/file/unfinished_file.hpp"
#include "runner/training/validation_ratio.hpp"

namespace rodsweep {

/// The metadata of a model: job, data sets, training history and quality.
struct Epoch {
  double training_loss = 0;    ///< mean over the epoch's examples, while the weights changed
  double validation_loss = 0;  ///< mean over the validation examples, at the end of the epoch
  double rate = 0;             ///< step size of the last step
  double seconds = 0;          ///< wall time
  ValidationRatio::Ratios cg_ratio = ValidationRatio::unmeasured();
  double processor_seconds = std::numeric_limits<double>::quiet_NaN();  ///< of all ranks
};

enum class Ending {
  none,      ///< the training can go on
  complete,  ///< all epochs
  early,     ///< no better validation loss within the job's patience
  diverged   ///< a loss is not finite
};

/// CG ratios on the validation simulations of one scene type.
struct SceneRatios {
  std::string scene;  ///< scene type
  ValidationRatio::Ratios cg_ratio, base_cg_ratio;
};

struct ModelCard {
  std::string name, job_text;        ///< of the job
  std::string data_path, data_hash;  ///< of the data sets (LearningSets::hash)
  std::int64_t training_simulations = 0, validation_simulations = 0;
  std::int64_t training_examples = 0, validation_examples = 0;

  std::int64_t planned_epochs = 0;
  std::vector<Epoch> epochs;
  std::int64_t best_epoch = 0;  ///< epoch of the model's weights, from 1, with the least validation loss; 0: none yet
  Ending ending = Ending::none;
  std::string message;  ///< about the ending; may be empty
  /// Means over `ratio_simulations` validation simulations at ValidationRatio::tolerances(): with the model, and with
  /// its base guess alone.
  ValidationRatio::Ratios cg_ratio = ValidationRatio::unmeasured(), base_cg_ratio = ValidationRatio::unmeasured();
  std::int64_t ratio_simulations = 0;
  std::vector<SceneRatios> scenes;  ///< the same by scene type; empty if there is only one

  std::vector<RunRow> runs;
};

/// The epoch of the model's weights. Requires best_epoch > 0.
inline const Epoch& best_epoch(const ModelCard& card) {
  return card.epochs.at(static_cast<std::size_t>(card.best_epoch) - 1);
}

inline constexpr int model_schema_version = 2;

/// A hash of settings, weights and scales: sixteen hexadecimal digits.
std::string model_hash(const Model& model);

/// The state needed to resume a training exactly, in addition to the best model and the finished epochs.
struct Checkpoint {
  AlignedVector<float> weights;
  Trainer::State optimiser;
  double epoch_loss = 0;     ///< sum of the losses of the current epoch's steps
  double epoch_seconds = 0;  ///< time spent on the current epoch
  double epoch_processor_seconds = 0;
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
