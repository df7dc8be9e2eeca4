// The summary printed after a run: tasks by outcome, first failures, solves that missed their tolerance, time,
// utilisation of workers, results file, and the command to type next.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "runner/command/exit_codes.hpp"
#include "runner/command/run_command.hpp"
#include "runner/dispatch/master.hpp"
#include "runner/file/inspect.hpp"

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

/// The exit code of the whole file, not only of this start: a resumed sweep with failed tasks returns tasks_failed.
ExitCode exit_code(const SweepSummary& summary);
std::string summary_text(const SweepSummary& summary);

/// Why tasks are left to do, and the command that continues them, on this many ranks.
std::string ended_text(const SweepSummary& summary, const RunOptions& options, int ranks);

}  // namespace rodsweep
