// A task that is to be done, as the master sees it.
#pragma once

#include <cstdint>
#include <limits>

namespace rodsweep {

struct PendingTask {
  std::int64_t index = 0;
  double cost = 0;
  std::int64_t batch = -1;  ///< tasks of equal cost and number here may be evaluated together; -1: this one alone
  int lost = 0;             ///< workers that ended while they ran it
  double tried_s = 0;       ///< the longest for which it ran and was given up
  double limit_s = std::numeric_limits<double>::infinity();  ///< of its own, after which it ends as timed out
};

}  // namespace rodsweep
