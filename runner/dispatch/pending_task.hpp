// A task that is to be done, as the master sees it.
#pragma once

#include <cstdint>
#include <limits>

namespace rodsweep {

struct PendingTask {
  std::int64_t index = 0;
  double cost = 0;
  std::int64_t batch = -1;  ///< tasks of equal cost and number here may be evaluated together; -1: this one alone
  int crashes = 0;          ///< workers that were lost while they ran it
  double tried_s = 0;       ///< its longest try that was abandoned
  double limit_s = std::numeric_limits<double>::infinity();  ///< its own time limit, after which it times out
};

}  // namespace rodsweep
