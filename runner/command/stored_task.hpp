// One task of a results file, to be run again from the job in that file: for `rerun` and `systems`.
// Throws FileError, with advice, if the file does not have the task, is itself a rerun, or is of another machine.
#pragma once

#include <cstdint>
#include <filesystem>

#include "runner/plan/plan.hpp"

namespace rodsweep {

struct StoredTask {
  Plan whole;  ///< of the file
  Plan alone;  ///< of the task
};

StoredTask stored_task(const std::filesystem::path& file, std::int64_t task, int trajectory_every);

}  // namespace rodsweep
