// One task in a sweep's file against the same task run again into a file of its own (Plan::alone()): everything that it
// wrote outside /timing, bit for bit, and the values that it was run with. Of the trajectories, the frames that both
// hold. What depends on a task's place in its file (its number, its first rows, its checksum) is left out.
// Throws FileError.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace rodsweep {

struct TaskComparison {
  int compared = 0;                    ///< datasets
  std::vector<std::string> differing;  ///< their paths
};

/// `sweep_every`, `rerun_every`: record.trajectory_every of the two; 0: no frames.
TaskComparison compare_task(const std::filesystem::path& sweep, std::int64_t task, std::int64_t sweep_every,
                            const std::filesystem::path& rerun, std::int64_t rerun_every);

}  // namespace rodsweep
