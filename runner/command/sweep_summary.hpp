// The end of a run in words: tasks by outcome, first failures, time, how busy the workers were, where the results are
// and what to type next.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "runner/command/exit_codes.hpp"
#include "runner/dispatch/master.hpp"

namespace rodsweep {

struct SweepSummary {
  std::int64_t tasks = 0;                      ///< of the plan
  std::map<std::string, std::int64_t> before;  ///< finished in earlier starts, by outcome
  Dispatch dispatch;                           ///< of this start
  int workers = 1;
  std::filesystem::path path;
};

/// Judges the whole file, not this start alone: a sweep with failed tasks stays one when it is resumed.
ExitCode exit_code(const SweepSummary& summary);
std::string summary_text(const SweepSummary& summary);

}  // namespace rodsweep
