// A run of a sweep, and its first part: the plan, the file, and the tasks that are left to do. Collective.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <vector>

#include "runner/command/run_command.hpp"
#include "runner/command/sweep_summary.hpp"
#include "runner/dispatch/stop_signal.hpp"
#include "runner/file/extension.hpp"
#include "runner/file/results_file.hpp"

namespace rodsweep {

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

}  // namespace rodsweep
