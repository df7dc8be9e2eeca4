// The times of finished tasks and the progress of abandoned tries, to estimate the time left.
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
  std::vector<double> elapsed_s;  ///< of finished tasks
  std::vector<Try> tried;
};

/// Throws FileError.
TaskTimes read_task_times(const std::filesystem::path& path);

}  // namespace rodsweep
