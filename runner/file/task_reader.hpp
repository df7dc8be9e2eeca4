// Reads the records of finished tasks from a results file, read-only, without MPI or a plan. Throws FileError if the
// file is not a results file or is inconsistent.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "runner/file/hdf5.hpp"
#include "runner/file/layout.hpp"
#include "runner/file/provenance.hpp"
#include "runner/file/record.hpp"
#include "runner/plan/task_list.hpp"
#include "runner/plan/task_outcome.hpp"

namespace rodsweep {

class TaskReader {
 public:
  enum class Times { read, left_out };
  /// `tasks`: of the file, if they are known: this reader then needs 3 bytes for each. They must outlive it.
  explicit TaskReader(const std::filesystem::path& path, Times times = Times::read, const TaskList* tasks = nullptr);

  /// Identity and rows of the tasks.
  const TaskList& tasks() const { return *tasks_; }

  /// Whether the task was complete when the file was opened.
  bool done(std::int64_t task) const { return states_[static_cast<std::size_t>(task)] == 1; }
  TaskOutcome outcome(std::int64_t task) const;  ///< TaskOutcome::pending if it was not complete

  /// Reads the record of a complete task; vectors of columns not in the file are empty. Returns false if the checksum
  /// is wrong.
  bool read(std::int64_t task, TaskRecord& record) const;

  /// The same, but also returns false if the record cannot be read.
  bool read_intact(std::int64_t task, TaskRecord& record) const;

  TaskOrigin origin(std::int64_t task) const;

 private:
  std::filesystem::path path_;
  hdf5::File file_;
  AxisSizes sizes_;
  std::shared_ptr<const TaskList> tasks_;
  std::vector<std::uint8_t> states_;
  std::vector<std::optional<TaskOutcome>> outcomes_;  ///< none: not the name of an outcome
  std::vector<hdf5::RowDataset> columns_;             ///< in the order of columns(); empty: not in the file
  TaskRows rows_;
};

}  // namespace rodsweep
