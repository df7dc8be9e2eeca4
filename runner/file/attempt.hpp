// How long tasks took, and how far those came that a start gave up, as their file says: what is left is judged by that.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace rodsweep {

/// The longest that a start ran a task which it gave up.
struct Attempt {
  double elapsed_s = 0;  ///< 0: none
  std::int32_t steps = 0;
};

/// By task.
struct TaskTimes {
  std::vector<double> elapsed_s;  ///< of those that are done
  std::vector<Attempt> tried;
};

/// Throws FileError.
TaskTimes read_task_times(const std::filesystem::path& path);

}  // namespace rodsweep
