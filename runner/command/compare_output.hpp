// How `rodsweep compare` says what it found: for people, as CSV (RFC 4180; nothing for what is not there) or as JSON.
#pragma once

#include <string>
#include <vector>

#include "runner/command/compare_command.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/sweep_comparison.hpp"
#include "runner/job/job_difference.hpp"

namespace rodsweep {

struct ComparedFiles {
  FileSummary a, b;
  MatchBy by;
  double headline;  ///< tolerance of the first job, of the ladder
  std::vector<KeyDifference> keys;
  std::int64_t both, only_a, only_b;  ///< tasks
  SweepComparison found;
};

std::string comparison_text(const ComparedFiles& files, bool tasks);
/// A row for every guess and tolerance, or for every task that differs.
std::string comparison_csv(const ComparedFiles& files, bool tasks);
std::string comparison_json(const ComparedFiles& files);

}  // namespace rodsweep
