// The end of a run in words: tasks by outcome, first failures, time, how busy the workers were, where the results are
// and what to type next.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "runner/command/exit_codes.hpp"
#include "runner/command/shard.hpp"
#include "runner/dispatch/master.hpp"

namespace rodsweep {

/// Tasks whose results alone are more than the memory of a rank.
struct TooLarge {
  std::int64_t tasks = 0;
  std::int64_t task = 0;   ///< the largest of them
  std::int64_t bytes = 0;  ///< of its results
};

struct SweepSummary {
  std::int64_t tasks = 0;                      ///< of the plan
  std::map<std::string, std::int64_t> before;  ///< finished in earlier starts, by outcome
  Dispatch dispatch;                           ///< of this start
  int workers = 1;
  std::filesystem::path path;
  std::string program{};         ///< as the user typed it
  TooLarge too_large{};          ///< of the tasks that are left
  std::optional<Shard> shard{};  ///< whose tasks alone this start had to do
};

/// Judges the whole file, not this start alone: a sweep with failed tasks stays one when it is resumed.
ExitCode exit_code(const SweepSummary& summary);
std::string summary_text(const SweepSummary& summary);

}  // namespace rodsweep
