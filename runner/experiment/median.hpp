// The median of repeated timings.
#pragma once

#include <algorithm>
#include <vector>

namespace rodsweep {

/// Of an even count the upper one, so that it is a time that was measured. Reorders.
inline double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace rodsweep
