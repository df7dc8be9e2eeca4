// A training, and the model that came of it, in words and as JSON.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "runner/training/model_file.hpp"

namespace rodsweep {

/// "epoch 34 of 120, loss 0.412, validation 0.431 (best 0.428), CG ratio 0.052 0.151 0.490 0.750, rate 1.7e-03, 1 min
/// 20 s left": the epoch that has begun, the results of the last one, the CG ratio measured last.
std::string progress_text(const ModelCard& card, double seconds_left);

/// The end of a training, or how far it came: a few lines for stdout.
std::string training_summary(const ModelCard& card, const std::filesystem::path& path);

/// What `info` adds: the model, its data, every start.
std::string provenance_text(const StoredModel& stored);
nlohmann::ordered_json to_json(const StoredModel& stored, const std::filesystem::path& path);

}  // namespace rodsweep
