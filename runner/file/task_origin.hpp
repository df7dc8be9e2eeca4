// Who ran a task: what the file knows of it beside its record (/timing/tasks).
#pragma once

#include <cstdint>
#include <string>

namespace rodsweep {

struct TaskOrigin {
  std::int32_t rank = 0;
  std::int32_t attempt = 0;  ///< row of /runs
  std::string host;
  double write_s = 0;
};

}  // namespace rodsweep
