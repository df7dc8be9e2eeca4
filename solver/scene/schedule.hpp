// A number over time: linear between given times, or smooth with zero speed at each of them; constant before and after.
#pragma once

#include <vector>

namespace rodsweep {

struct Schedule {
  std::vector<double> times_s, factors;  ///< of equal length; both empty: 1 at all times
  bool smooth = false;

  double at(double time_s) const;
  double largest() const;  ///< magnitude
  /// Throws SceneError unless times increase and each has a factor.
  void check() const;
};

}  // namespace rodsweep
