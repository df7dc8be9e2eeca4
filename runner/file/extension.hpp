// What an earlier file of a smaller job saves a sweep (--extend). Two tasks are the same when all that their results
// depend on is (TaskIdentity), wherever they stand in their plans. A task of the new plan is then
//   copied     the earlier file holds it with every guess that it wants: its rows are taken over;
//   completed  a paired task that wants more guesses: its trajectory is simulated again by the direct solve, the new
//              guesses alone are tried on it, and the others' rows are taken over;
//   run        all else, also what timed out or ended in an error before, which another attempt may not.
// The earlier file is read only. Whoever takes a task over checks its sum: a damaged one is run.
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
  /// Throws JobError where the plan's job is no extension of the file's, FileError about the file. The plan must
  /// outlive this.
  Extension(const std::filesystem::path& path, const Plan& plan);

  enum class Use { run, complete, copy };
  Use use(std::int64_t task) const { return uses_[static_cast<std::size_t>(task)].use; }
  std::int64_t source(std::int64_t task) const { return uses_[static_cast<std::size_t>(task)].task; }  ///< or -1
  std::int64_t count(Use use) const;

  /// Throws FileError unless the file `path` was begun as an extension of this one as it is now.
  void check_started(const std::filesystem::path& path) const;

  /// Relative to a task that is run in full.
  double cost(std::int64_t task) const;

  /// Fills `record`, sized for the plan's task, with what its source holds of it: all rows without guess axis, and the
  /// columns of the guesses that are found there, marked 1 in record.copied_guess. False, with `record` as prepared:
  /// the source is damaged.
  bool take(std::int64_t task, TaskRecord& record) const;

  TaskOrigin origin(std::int64_t task) const { return reader_->origin(source(task)); }

  const std::filesystem::path& path() const { return path_; }
  const std::string& note() const { return note_; }  ///< what the user should hear though it is no error; or empty

 private:
  struct Source {
    std::int64_t task = -1;
    Use use = Use::run;
    int missing = 0;  ///< guesses that it lacks
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

/// Where a record that was simulated again differs from what was taken over, in rows without guess axis outside
/// /timing: "/steps/joint_gap[3] is 1e-9 and was 2e-9"; empty: nowhere, to the last bit. Where they are equal, the
/// columns of the guesses marked in taken.copied_guess are put into `record`.
std::string complete(const Task& task, TaskRecord& record, const TaskRecord& taken);

}  // namespace rodsweep
