// The metadata of a model: job, data sets, training history and quality.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "runner/file/provenance.hpp"
#include "runner/training/validation_ratio.hpp"

namespace rodsweep {

struct Epoch {
  double training_loss = 0;    ///< mean over the epoch's examples, while the weights changed
  double validation_loss = 0;  ///< mean over the validation examples, at the end of the epoch
  double rate = 0;             ///< step size of the last step
  double seconds = 0;          ///< wall time
  ValidationRatio::Ratios cg_ratio = ValidationRatio::unmeasured();
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

}  // namespace rodsweep
