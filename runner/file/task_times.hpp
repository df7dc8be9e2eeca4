// How long tasks took, and how far abandoned tries came: the time of what is left is estimated from these.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace rodsweep {

/// The longest abandoned try of a task.
struct Try {
  double elapsed_s = 0;  ///< 0: none
  std::int32_t steps = 0;
};

/// By task.
struct TaskTimes {
  std::vector<double> elapsed_s;  ///< of those that are done
  std::vector<Try> tried;
};

/// Throws FileError.
TaskTimes read_task_times(const std::filesystem::path& path);

}  // namespace rodsweep
