// Reads the records of finished tasks back from a results file, read-only, without MPI and without a plan. Throws
// FileError for a file that is none, or contradicts itself.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runner/file/hdf5.hpp"
#include "runner/file/provenance.hpp"
#include "runner/file/record.hpp"

namespace rodsweep {

class TaskReader {
 public:
  enum class Times { read, left_out };
  explicit TaskReader(const std::filesystem::path& path, Times times = Times::read);

  /// As the file tells them: identity and rows.
  const std::vector<Task>& tasks() const { return tasks_; }

  /// Was it complete when the file was opened?
  bool done(std::int64_t task) const { return states_[static_cast<std::size_t>(task)] == 1; }
  TaskOutcome outcome(std::int64_t task) const;  ///< TaskOutcome::pending where it was not

  /// The whole record of a complete task, empty vectors where the file leaves a column out. False: it does not have the
  /// checksum that it was written with.
  bool read(std::int64_t task, TaskRecord& record) const;

  /// The same, and false also where it cannot be read at all.
  bool read_intact(std::int64_t task, TaskRecord& record) const;

  TaskOrigin origin(std::int64_t task) const;

 private:
  std::filesystem::path path_;
  hdf5::File file_;
  AxisSizes sizes_;
  std::vector<Task> tasks_;
  std::vector<std::uint8_t> states_;
  std::vector<std::string> outcomes_;
  std::vector<hdf5::RowDataset> columns_;  ///< in the order of columns(); empty: the file leaves it out
  hdf5::RowDataset message_, checksum_, rank_, host_, run_, write_s_;
};

}  // namespace rodsweep
