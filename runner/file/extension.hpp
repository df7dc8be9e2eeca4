// Reuses results of an earlier file of a smaller job (--extend). Two tasks are equal if all inputs of their results are
// (TaskInputs), regardless of their indices. A task of the new plan that the earlier file has is copied. The others
// are run, also those that timed out or ended in an error before, because a retry may succeed.
// The earlier file is opened read-only. The checksum of each copied task is verified; a damaged one is run.
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

  /// The same task in the earlier file; -1 if this one is run.
  std::int64_t source(std::int64_t task) const { return sources_[static_cast<std::size_t>(task)]; }
  std::int64_t copied() const;  ///< number of tasks with a source

  /// Throws FileError unless the file `path` was started as an extension of this one in its current state.
  void check_started(const std::filesystem::path& path) const;

  /// Relative to running the task.
  double cost(std::int64_t task) const;

  /// Fills `record`, prepared for the plan's task, from its source. Returns false, with `record` unchanged, if the
  /// source is damaged.
  bool take(std::int64_t task, TaskRecord& record) const;

  TaskOrigin origin(std::int64_t task) const { return reader_->origin(source(task)); }

  const std::filesystem::path& path() const { return path_; }
  const std::string& note() const { return note_; }  ///< a warning for the user; may be empty

 private:
  std::filesystem::path path_;
  const Plan* plan_;
  std::optional<Plan> before_;
  std::optional<TaskReader> reader_;
  std::vector<std::int64_t> sources_;
  std::string note_;
};

}  // namespace rodsweep
