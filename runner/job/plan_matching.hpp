// Which tasks of two plans are the same: by all that their results depend on (TaskIdentity), or by the parameters that
// vary within either plan alone, where the jobs differ in something on purpose. What a job records, and its time limit,
// make no task another one.
#pragma once

#include <cstdint>
#include <vector>

#include "runner/job/plan.hpp"

namespace rodsweep {

enum class MatchBy { everything, parameters };

/// A task of plan a and the same one of plan b, with their numbers there.
struct TaskPair {
  std::int64_t a = 0, b = 0;
  std::vector<int> guesses;  ///< by place on the guess axis of a: the same guess's on that of b, or -1
};

struct PlanMatch {
  std::vector<TaskPair> pairs;  ///< in the order of a; no task is in two of them
  std::vector<std::int64_t> only_a, only_b;
};

/// Guesses are the same by name and parameters; with MatchBy::parameters by their label. Of several tasks of b that
/// differ in a guess alone, the one with most guesses of a task of a is its own.
PlanMatch match(const Plan& a, const Plan& b, MatchBy by);

}  // namespace rodsweep
