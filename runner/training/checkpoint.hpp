// All that must be kept of a training to go on exactly, beside the model kept and the epochs so far.
#pragma once

#include "network/training/trainer.hpp"

namespace rodsweep {

struct Checkpoint {
  AlignedVector<float> weights;
  Trainer::State optimiser;
  double epoch_loss = 0;     ///< sum of the losses of the steps of the epoch that has begun
  double epoch_seconds = 0;  ///< time spent on it
};

}  // namespace rodsweep
