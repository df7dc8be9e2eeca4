// Reads the records of finished tasks back from a results file, read-only and without MPI, by the plan that the file
// was made from. Throws FileError for a file that is none, or was not made from that plan.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runner/file/hdf5.hpp"
#include "runner/file/record.hpp"
#include "runner/file/task_origin.hpp"
#include "runner/job/plan.hpp"

namespace rodsweep {

class TaskReader {
 public:
  /// The plan must outlive the reader. `advice` ends the message about a file that another revision made.
  TaskReader(const std::filesystem::path& path, const Plan& plan, const char* advice);

  /// TaskOutcome::pending where a task is not complete.
  TaskOutcome outcome(std::int64_t task) const { return outcomes_[static_cast<std::size_t>(task)]; }

  /// The whole record of a complete task. False: it cannot be read, or does not have the checksum that it was written
  /// with.
  bool read(std::int64_t task, TaskRecord& record) const;

  TaskOrigin origin(std::int64_t task) const;

 private:
  hdf5::File file_;
  const Plan* plan_;
  AxisSizes sizes_;
  std::vector<hdf5::RowDataset> columns_;  ///< in the order of visit_columns(); empty: the file leaves it out
  hdf5::RowDataset checksum_, rank_, attempt_, write_s_;
  std::vector<TaskOutcome> outcomes_;
};

}  // namespace rodsweep
