// Where a linear system is solved as well as it can be told.
#pragma once

namespace rodsweep {

/// Residuals and right-hand sides whose largest entry is up to this are rounding: entries are dimensionless, of
/// order 1.
inline constexpr double rounding_level = 1e-13;

}  // namespace rodsweep
