// The larger of two numbers, or NaN where either is: std::max forgets a NaN that comes second.
#pragma once

#include <cmath>

namespace rodsweep {

inline double larger_or_nan(double a, double b) { return a > b || std::isnan(a) ? a : b; }

}  // namespace rodsweep
