// The larger of two numbers, or NaN if either is NaN: std::max ignores a NaN in second place.
#pragma once

#include <cmath>

namespace rodsweep {

inline double larger_or_nan(double a, double b) { return a > b || std::isnan(a) ? a : b; }

}  // namespace rodsweep
