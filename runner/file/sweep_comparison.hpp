// Two results files, task by task: what the same tasks wrote outside /timing, bit for bit, and where they differ by how
// much; their CG ratios in the mean; and their times, which nobody expects to be equal. Columns whose rows or axes are
// not the same in both (a job that records less, more steps) are left out and named. Throws FileError.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runner/file/bootstrap.hpp"
#include "runner/job/plan_matching.hpp"

namespace rodsweep {

struct ColumnDifference {
  std::string path;
  std::int64_t tasks = 0, values = 0;  ///< that differ
  double largest = 0;                  ///< |b - a|; infinite: one of them is not there
  std::int64_t task = -1;              ///< of file a, in which it is
};

/// A pair whose results differ.
struct TaskDifference {
  std::int64_t a = 0, b = 0;
  std::string outcome_a, outcome_b;
  std::vector<std::string> columns;  ///< paths
};

/// The ratio of a guess at a tolerance, over the tasks that are ok in both.
struct RatioComparison {
  std::string guess;  ///< its label in file a
  double tolerance = 0;
  Estimate a, b, difference;  ///< b - a, task by task
};

/// Medians over the tasks that are ok in both, of each task's median over its solves.
struct TimeComparison {
  std::string what;                    ///< "task", "direct solve", "guess and CG, LABEL"
  double a_s = 0, b_s = 0, ratio = 0;  ///< ratio: the median of the tasks' b / a
  std::int64_t tasks = 0;
};

struct SweepComparison {
  std::int64_t pending = 0;       ///< pairs that are not done in both files
  std::vector<TaskPair> damaged;  ///< that do not have their checksum in one of them
  std::int64_t compared = 0;      ///< all others
  std::vector<TaskDifference> differing;
  std::vector<ColumnDifference> columns;  ///< in the order of the file
  std::vector<std::string> left_out;      ///< paths
  std::vector<RatioComparison> ratios;    ///< by guess of a, then tolerance; none of the zero guess
  std::vector<TimeComparison> times;
};

SweepComparison compare_sweeps(const std::filesystem::path& a, const Plan& plan_a, const std::filesystem::path& b,
                               const Plan& plan_b, const std::vector<TaskPair>& pairs);

}  // namespace rodsweep
