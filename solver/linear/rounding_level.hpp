// The size of rounding errors in a linear system.
#pragma once

namespace rodsweep {

/// Residuals and right-hand sides with no larger entry than this are rounding errors: entries are dimensionless and of
/// order 1.
inline constexpr double rounding_level = 1e-13;

}  // namespace rodsweep
