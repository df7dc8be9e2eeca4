// What a training goes on from: the file that an earlier start of the same job has left.
#pragma once

#include <filesystem>
#include <optional>

#include "runner/command/run_command.hpp"
#include "runner/job/job.hpp"
#include "runner/training/model_file.hpp"

namespace rodsweep {

/// With --resume and where the file is there; without --resume a file that is there is refused. Throws FileError for a
/// file of another job.
std::optional<StoredModel> earlier_training(const RunOptions& options, const Job& job,
                                            const std::filesystem::path& path);

}  // namespace rodsweep
