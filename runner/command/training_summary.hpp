// The report on a training and its model, as text and as JSON.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "runner/training/model_file.hpp"

namespace rodsweep {

/// "epoch 34 of 120, loss 0.412, validation 0.431 (best 0.428), CG ratio 0.052 0.151 0.490 0.750, rate 1.7e-03, 1 min
/// 20 s left": the current epoch, the losses of the last finished one, and the latest CG ratio.
std::string progress_text(const ModelCard& card, double seconds_left);

/// A few lines for stdout: the result or the progress of a training.
std::string training_summary(const ModelCard& card, const std::filesystem::path& path);

/// The additional lines of `info`: model, data, all runs.
std::string provenance_text(const StoredModel& stored);
nlohmann::ordered_json to_json(const StoredModel& stored, const std::filesystem::path& path);

// What a run of a training and one of a sweep have in common.

nlohmann::ordered_json to_json(const RunRow& run);
std::string program_text(const Provenance& provenance);  ///< command, revision, versions: a line each

}  // namespace rodsweep
