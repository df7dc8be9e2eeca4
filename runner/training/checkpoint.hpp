// The state needed to resume a training exactly, in addition to the best model and the finished epochs.
#pragma once

#include "network/training/trainer.hpp"

namespace rodsweep {

struct Checkpoint {
  AlignedVector<float> weights;
  Trainer::State optimiser;
  double epoch_loss = 0;     ///< sum of the losses of the current epoch's steps
  double epoch_seconds = 0;  ///< time spent on the current epoch
};

}  // namespace rodsweep
