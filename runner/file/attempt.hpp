// How long a task took and how far it came, as its file says: a task that is done, or the longest that one which is not
// ran in a start that gave it up. What tasks still need is judged by that.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace rodsweep {

struct Attempt {
  double elapsed_s = 0;  ///< 0: none
  std::int32_t steps = 0;
};

/// Of every task. Throws FileError.
std::vector<Attempt> read_attempts(const std::filesystem::path& path);

}  // namespace rodsweep
