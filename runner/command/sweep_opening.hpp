// A run of a sweep, its first part (the plan, the file, and the tasks that are left to do), and its summary. Opening is
// collective.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "runner/command/exit_codes.hpp"
#include "runner/command/run_command.hpp"
#include "runner/dispatch/master.hpp"
#include "runner/dispatch/stop_signal.hpp"
#include "runner/file/extension.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/results_file.hpp"

namespace rodsweep {

/// Tasks whose results exceed the memory of a rank.
struct TooLarge {
  std::int64_t tasks = 0;
  std::int64_t task = 0;   ///< the largest of them
  std::int64_t bytes = 0;  ///< size of its results
};

struct SweepSummary {
  std::int64_t tasks = 0;                      ///< in the plan
  std::map<std::string, std::int64_t> before;  ///< finished in earlier runs, by outcome
  Dispatch dispatch;                           ///< of this start
  int workers = 1;
  std::filesystem::path path;
  std::string program{};         ///< as the user typed it
  TooLarge too_large{};          ///< among the tasks left
  std::optional<Shard> shard{};  ///< of this start
  SolveCounts solves{};          ///< of the whole file
};

struct Sweep {
  using Clock = std::chrono::steady_clock;

  /// Plans the job.
  Sweep(const RunOptions& options, const Job& job, const MpiSession& mpi, Console& console);

  const RunOptions& options;
  const Job& job;
  const MpiSession& mpi;
  Console& console;
  const Clock::time_point begin = Clock::now();
  const Plan plan;
  const StopSignal signal;  ///< from here until the file is closed, a signal only requests a stop
  const std::filesystem::path path;
  std::optional<Extension> extension;
  std::optional<ResultsFile> file;
  std::vector<PendingTask> tasks;  ///< left to do; only rank 0 has them
  std::int64_t failed_before = 0;  ///< tasks, in earlier runs
  SweepSummary summary;
};

/// Creates or continues the file, and lists the tasks that are left to do. Returns false if a signal stopped it while it
/// verified the file: then the file is unchanged, and summary.dispatch has the signal.
bool open_sweep(Sweep& sweep);

// The tasks that a run has to do: all tasks of the plan, less those that a row of filters leaves out. The time limit is
// the master's: it knows what a task takes.

/// `tries`: of each task, in earlier runs whose worker crashed. A task that `extension` copies costs little.
std::vector<PendingTask> all_tasks(const Plan& plan, const std::vector<std::uint8_t>& tries,
                                   const std::optional<Extension>& extension);

/// Whether a task stays in the list.
using TaskFilter = std::function<bool(const PendingTask&)>;

/// Removes the tasks that do not pass, and returns them.
std::vector<PendingTask> leave_out(std::vector<PendingTask>& tasks, const TaskFilter& stays);

/// `done`: a flag per task of the plan.
TaskFilter not_done(const std::vector<std::uint8_t>& done);
TaskFilter not_crashed(int max_crashes);
/// Tasks are dealt out by descending cost, so that shards take similar times. All pass without a shard.
TaskFilter in_shard(const Plan& plan, const std::optional<Shard>& shard);
/// Whether the results of a task fit into `memory` bytes.
TaskFilter fits_memory(const Plan& plan, double memory);

/// The number of these tasks, and the one with the largest results.
TooLarge largest_of(const std::vector<PendingTask>& tasks, const Plan& plan);

/// Stores a task as crashed after its last allowed crash, and returns its message. Called on one rank.
std::string store_as_crashed(const Task& task, int crashes, const Plan& plan, ResultsFile& file);

// The summary printed after a run, in sweep_summary.cpp: tasks by outcome, first failures, solves that missed their
// tolerance, time, utilisation of workers, results file, and the command to type next.

/// The exit code of the whole file, not only of this start: a resumed sweep with failed tasks returns tasks_failed.
ExitCode exit_code(const SweepSummary& summary);
std::string summary_text(const SweepSummary& summary);

/// Why tasks are left to do, and the command that continues them, on this many ranks.
std::string ended_text(const SweepSummary& summary, const RunOptions& options, int ranks);

}  // namespace rodsweep
