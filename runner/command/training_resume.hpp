// Reads the file of an earlier run, to resume its training.
#pragma once

#include <filesystem>
#include <optional>

#include "runner/command/run_command.hpp"
#include "runner/job/job.hpp"
#include "runner/training/model_file.hpp"

namespace rodsweep {

/// The stored training; none if the file does not exist. Throws FileError if the file exists without --resume, or if it
/// belongs to another job.
std::optional<StoredModel> earlier_training(const RunOptions& options, const Job& job,
                                            const std::filesystem::path& path);

}  // namespace rodsweep
