// A task not yet done, with the master's data on it.
#pragma once

#include <cstdint>
#include <limits>

namespace rodsweep {

struct PendingTask {
  std::int64_t index = 0;
  double cost = 0;
  int crashes = 0;                                           ///< workers lost while running it
  double tried_s = 0;                                        ///< its longest abandoned try
  double limit_s = std::numeric_limits<double>::infinity();  ///< its own time limit
};

}  // namespace rodsweep
