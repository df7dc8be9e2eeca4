// 6x6 blocks and vectors of six of several struts at once, one strut per lane: the kernels of a block LDL^T.
//
// Symmetric blocks store only the lower triangle, by rows; other blocks are arrays of six columns. L is unit lower
// triangular, stored by rows below the diagonal. Loops over the entries of a triangle unroll, which keeps them in
// registers. Loops over columns do not unroll, so that only a triangle and a column need registers.
#pragma once

#include "solver/numbers/lane_math.hpp"

namespace rodsweep {

struct LaneVector6 {
  Lane row[6];

  const Lane& operator[](int i) const { return row[i]; }
  Lane& operator[](int i) { return row[i]; }
};

/// Symmetric.
struct LaneBlock {
  LaneVector6 row[6];

  const LaneVector6& operator[](int i) const { return row[i]; }
  LaneVector6& operator[](int i) { return row[i]; }
};

struct LaneFactor {
  Lane l[15];
  LaneVector6 inverse_pivot;  ///< 1 / d

  const Lane& at(int row, int column) const { return l[row * (row - 1) / 2 + column]; }
  Lane& at(int row, int column) { return l[row * (row - 1) / 2 + column]; }
};

/// S = L D L^T; overwrites s. Returns the lanes in which all pivots are positive (false for NaN). Pivots come in pairs,
/// the second as the determinant of both over the first, so that it does not depend on the first division.
inline LaneMask factorise(LaneBlock& s, LaneFactor& out) {
  LaneMask positive = Lane{} < 1;
#pragma GCC unroll 3
  for (int j = 0; j < 6; j += 2) {
    const Lane determinant = s[j][j] * s[j + 1][j + 1] - s[j + 1][j] * s[j + 1][j];
    positive &= (s[j][j] > 0) & (determinant > 0);
    out.inverse_pivot[j] = 1 / s[j][j];
    out.inverse_pivot[j + 1] = s[j][j] / determinant;
#pragma GCC unroll 2
    for (int c = j; c < j + 2; ++c)
#pragma GCC unroll 6
      for (int i = c + 1; i < 6; ++i) {
        out.at(i, c) = s[i][c] * out.inverse_pivot[c];
#pragma GCC unroll 6
        for (int k = c + 1; k <= i; ++k) s[i][k] -= out.at(i, c) * s[k][c];
      }
  }
  return positive;
}

/// v <- L^-1 v.
inline void forward(const LaneFactor& factor, LaneVector6& v) {
#pragma GCC unroll 6
  for (int i = 1; i < 6; ++i)
#pragma GCC unroll 6
    for (int j = 0; j < i; ++j) v[i] -= factor.at(i, j) * v[j];
}

/// v <- L^-T v.
inline void backward(const LaneFactor& factor, LaneVector6& v) {
#pragma GCC unroll 6
  for (int i = 4; i >= 0; --i)
#pragma GCC unroll 6
    for (int j = i + 1; j < 6; ++j) v[i] -= factor.at(j, i) * v[j];
}

/// D^-1 v.
inline LaneVector6 divided(const LaneFactor& factor, const LaneVector6& v) {
  LaneVector6 out;
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i) out[i] = factor.inverse_pivot[i] * v[i];
  return out;
}

/// s <- s + v v^T.
inline void add_square(LaneBlock& s, const LaneVector6& v) {
#pragma GCC unroll 6
  for (int c = 0; c < 6; ++c)
#pragma GCC unroll 6
    for (int r = c; r < 6; ++r) s[r][c] += v[r] * v[c];
}

/// s <- s - W^T U, which is symmetric, and v <- v - W^T y.
inline void subtract_products(LaneBlock& s, LaneVector6& v, const LaneVector6 (&w)[6], const LaneVector6 (&u)[6],
                              const LaneVector6& y) {
#pragma GCC unroll 1
  for (int i = 0; i < 6; ++i)
#pragma GCC unroll 6
    for (int c = 0; c < 6; ++c) {
      v[c] -= w[c][i] * y[i];
#pragma GCC unroll 6
      for (int r = c; r < 6; ++r) s[r][c] -= w[r][i] * u[c][i];
    }
}

/// v <- v - U x.
inline void subtract_product(LaneVector6& v, const LaneVector6 (&u)[6], const LaneVector6& x) {
#pragma GCC unroll 6
  for (int c = 0; c < 6; ++c)
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) v[i] -= u[c][i] * x[c];
}

}  // namespace rodsweep
