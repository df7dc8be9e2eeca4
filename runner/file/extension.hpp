// Reuses results of an earlier file of a smaller job (--extend). Two tasks are equal if all inputs of their results are
// (TaskIdentity), regardless of their indices. Each task of the new plan is
//   copied     if the earlier file has it with all its guesses: its rows are copied;
//   completed  if a paired task needs more guesses: its trajectory is simulated again by the direct solve with the
//              new guesses only, and the rows of the other guesses are copied;
//   run        otherwise, also if it timed out or ended in an error before, because a retry may succeed.
// The earlier file is opened read-only. The checksum of each reused task is verified; a damaged one is run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/file/task_reader.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

class Extension {
 public:
  /// Throws JobError if the plan's job does not extend the file's job, FileError for errors of the file. The plan must
  /// outlive this.
  Extension(const std::filesystem::path& path, const Plan& plan);

  enum class Use { run, complete, copy };
  Use use(std::int64_t task) const { return uses_[static_cast<std::size_t>(task)].use; }
  std::int64_t source(std::int64_t task) const { return uses_[static_cast<std::size_t>(task)].task; }  ///< or -1
  std::int64_t count(Use use) const;

  /// Throws FileError unless the file `path` was started as an extension of this one in its current state.
  void check_started(const std::filesystem::path& path) const;

  /// Relative to running the task in full.
  double cost(std::int64_t task) const;

  /// Fills `record`, prepared for the plan's task, from its source: all rows without guess axis, and the columns of the
  /// guesses found there, marked 1 in record.timing.copied_guess. Returns false, with `record` unchanged, if the source is
  /// damaged.
  bool take(std::int64_t task, TaskRecord& record) const;

  TaskOrigin origin(std::int64_t task) const { return reader_->origin(source(task)); }

  const std::filesystem::path& path() const { return path_; }
  const std::string& note() const { return note_; }  ///< a warning for the user; may be empty

 private:
  struct Source {
    std::int64_t task = -1;
    Use use = Use::run;
    int missing = 0;  ///< number of guesses not in the source
  };
  std::vector<int> sources(const Task& task, const TaskIdentity& wanted, const Task& source,
                           const TaskIdentity& found) const;
  Source find(const Task& task, const TaskIdentity& wanted, const std::vector<std::int64_t>& candidates) const;

  std::filesystem::path path_;
  const Plan* plan_;
  std::optional<Plan> before_;
  std::optional<TaskReader> reader_;
  std::vector<Source> uses_;
  std::string note_;
};

/// Compares a repeated record with the stored one, in rows without guess axis outside /timing. Returns the first
/// difference: "/steps/joint_gap, value 3, is 1e-9 and was 2e-9". Returns empty if they are bitwise equal; then copies
/// the columns of the guesses marked in taken.timing.copied_guess to `record`.
std::string complete(const Task& task, TaskRecord& record, const TaskRecord& taken);

}  // namespace rodsweep
