// Compares a task in a sweep's file with a rerun of it in a separate file (Plan::alone()): all results outside /timing,
// bit by bit, and the parameters. Trajectories are compared at common frames. Data that depends on the task's place in
// its file (index, first rows, checksum) is skipped. Throws FileError.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace rodsweep {

struct TaskComparison {
  int compared = 0;                    ///< datasets
  std::vector<std::string> differing;  ///< paths of these datasets
};

/// `sweep_every`, `rerun_every`: record.trajectory_every of each; 0: no frames.
TaskComparison compare_task(const std::filesystem::path& sweep, std::int64_t task, std::int64_t sweep_every,
                            const std::filesystem::path& rerun, std::int64_t rerun_every);

}  // namespace rodsweep
