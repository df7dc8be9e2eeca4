#include "runner/command/stored_task.hpp"

#include <fmt/format.h>

#include <utility>

#include "runner/file/inspect.hpp"
#include "runner/file/resume_check.hpp"
#include "runner/file/stored_plan.hpp"

namespace rodsweep {

StoredTask stored_task(const std::filesystem::path& file, std::int64_t task, int trajectory_every) {
  const FileSummary summary = inspect(file);
  if (summary.rerun_of_task)
    throw FileError(fmt::format("{} holds only task {} of a sweep, from `rodsweep rerun`: use the file of the sweep",
                                file.native(), *summary.rerun_of_task));
  if (task < 0 || task >= summary.tasks)
    throw FileError(fmt::format("{} has no task {}: must be from 0 to {}", file.native(), task, summary.tasks - 1));
  Plan whole = stored_plan(summary);
  check_same_tasks(file, whole);
  Plan alone = whole.alone(task, trajectory_every);
  return {std::move(whole), std::move(alone)};
}

}  // namespace rodsweep
