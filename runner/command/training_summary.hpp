// A training in words: how far it is, and what came of it.
#pragma once

#include <filesystem>
#include <string>

#include "runner/training/model_card.hpp"

namespace rodsweep {

/// "epoch 34 of 120, loss 0.412, validation 0.431 (best 0.428), CG ratio 0.052 0.151 0.490 0.750, rate 1.7e-03, 1 min
/// 20 s left": the epoch that has begun, the results of the last one, the CG ratio measured last.
std::string progress_text(const ModelCard& card, double seconds_left);

/// The end of a training, or how far it came: a few lines for stdout.
std::string training_summary(const ModelCard& card, const std::filesystem::path& path);

}  // namespace rodsweep
