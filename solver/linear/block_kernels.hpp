// Kernels on one 6x6 block whose rows are lanes: its inversion by Gauss-Jordan steps on whole rows, with a right-hand
// side that rides along in the spare lane 6.
#pragma once

#include "solver/numbers/lanes.hpp"

namespace rodsweep {

/// `value` with lane 6 of `from`.
inline Lane8 with_lane_6(const Lane8& value, const Lane8& from) {
  return __builtin_shufflevector(value, from, 0, 1, 2, 3, 4, 5, 14, 7);
}

/// The row operations that invert S: row k loses factor[j][k] times row j, then row j is scaled by inverse[j].
struct RowOperations {
  Lane8 factor[6][6];
  Lane8 inverse[6];
};

/// Gauss-Jordan on the rows of S (lane 6: right-hand side). Afterwards row j holds d_j y_j in lane 6.
/// Returns false at a pivot d_j that is not positive (or NaN).
inline bool invert(Lane8 (&s)[6], RowOperations& ops) {
  bool positive = true;
#pragma GCC unroll 6
  for (int j = 0; j < 6; ++j) {
    positive &= s[j][j] > 0;
    ops.inverse[j] = broadcast(1 / s[j][j]);
#pragma GCC unroll 6
    for (int k = 0; k < 6; ++k) {
      if (k == j) continue;
      ops.factor[j][k] = broadcast(s[k][j]) * ops.inverse[j];
      s[k] -= ops.factor[j][k] * s[j];
    }
  }
  return positive;
}

}  // namespace rodsweep
