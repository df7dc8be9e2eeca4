// The median of repeated timings.
#pragma once

#include <algorithm>
#include <vector>

namespace rodsweep {

/// The upper median if the count is even, so that the result is a measured time. Reorders `values`.
inline double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace rodsweep
