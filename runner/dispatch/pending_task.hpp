// A task not yet done, with the master's data on it.
#pragma once

#include <cstdint>

namespace rodsweep {

struct PendingTask {
  std::int64_t index = 0;
  double cost = 0;
  int crashes = 0;  ///< workers lost while running it
};

}  // namespace rodsweep
