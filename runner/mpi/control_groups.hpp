// Limits of this process's control groups (versions 1 and 2) and their ancestors, as Slurm and containers set them;
// infinity without a limit. Tests replace / and /proc by `root` and `proc`.
#pragma once

#include <filesystem>

namespace rodsweep {

double memory_quota(const std::filesystem::path& root = "/", const std::filesystem::path& proc = "/proc");  ///< bytes

/// Processors: the time that the process may compute, over the time that passes.
double cpu_quota(const std::filesystem::path& root = "/", const std::filesystem::path& proc = "/proc");

}  // namespace rodsweep
