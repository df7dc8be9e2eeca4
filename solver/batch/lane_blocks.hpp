// 6x6 blocks and vectors of six of eight rods at once, one rod per lane: the kernels of a block LDL^T.
//
// Of symmetric blocks only the lower triangle is touched. L is unit lower triangular, its rows below the diagonal one
// after the other. Everything unrolls, so that entries live in registers.
#pragma once

#include "solver/numbers/lane_math.hpp"

namespace rodsweep {

struct LaneVector6 {
  Lane8 row[6];

  const Lane8& operator[](int i) const { return row[i]; }
  Lane8& operator[](int i) { return row[i]; }
};

struct LaneBlock {
  LaneVector6 row[6];

  const LaneVector6& operator[](int i) const { return row[i]; }
  LaneVector6& operator[](int i) { return row[i]; }
};

struct LaneFactor {
  Lane8 l[15];
  LaneVector6 inverse_pivot;  ///< 1 / d

  const Lane8& at(int row, int column) const { return l[row * (row - 1) / 2 + column]; }
  Lane8& at(int row, int column) { return l[row * (row - 1) / 2 + column]; }
};

/// S = L D L^T; s is used up. Returns where all pivots are positive (false for NaN).
inline LaneMask factorise(LaneBlock& s, LaneFactor& out) {
  LaneMask positive = s[0][0] > 0;
#pragma GCC unroll 6
  for (int j = 0; j < 6; ++j) {
    const Lane8 pivot = s[j][j];
    positive &= pivot > 0;
    out.inverse_pivot[j] = 1 / pivot;
#pragma GCC unroll 6
    for (int i = j + 1; i < 6; ++i) {
      out.at(i, j) = s[i][j] * out.inverse_pivot[j];
#pragma GCC unroll 6
      for (int k = j + 1; k <= i; ++k) s[i][k] -= out.at(i, j) * s[k][j];
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

/// B <- L^-1 B.
inline void forward(const LaneFactor& factor, LaneBlock& b) {
#pragma GCC unroll 6
  for (int i = 1; i < 6; ++i)
#pragma GCC unroll 6
    for (int j = 0; j < i; ++j)
#pragma GCC unroll 6
      for (int c = 0; c < 6; ++c) b[i][c] -= factor.at(i, j) * b[j][c];
}

/// v <- L^-T v.
inline void backward(const LaneFactor& factor, LaneVector6& v) {
#pragma GCC unroll 6
  for (int i = 4; i >= 0; --i)
#pragma GCC unroll 6
    for (int j = i + 1; j < 6; ++j) v[i] -= factor.at(j, i) * v[j];
}

/// D^-1 v and D^-1 B.
inline LaneVector6 divided(const LaneFactor& factor, const LaneVector6& v) {
  LaneVector6 out;
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i) out[i] = factor.inverse_pivot[i] * v[i];
  return out;
}
inline LaneBlock divided(const LaneFactor& factor, const LaneBlock& b) {
  LaneBlock out;
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i)
#pragma GCC unroll 6
    for (int c = 0; c < 6; ++c) out[i][c] = factor.inverse_pivot[i] * b[i][c];
  return out;
}

/// The lower triangle of -W^T U, which is symmetric.
inline LaneBlock minus_gram(const LaneBlock& w, const LaneBlock& u) {
  LaneBlock out{};
#pragma GCC unroll 6
  for (int r = 0; r < 6; ++r)
#pragma GCC unroll 6
    for (int c = 0; c <= r; ++c)
#pragma GCC unroll 6
      for (int i = 0; i < 6; ++i) out[r][c] -= w[i][r] * u[i][c];
  return out;
}

/// -W^T v.
inline LaneVector6 minus_product(const LaneBlock& w, const LaneVector6& v) {
  LaneVector6 out{};
#pragma GCC unroll 6
  for (int r = 0; r < 6; ++r)
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) out[r] -= w[i][r] * v[i];
  return out;
}

/// v <- v - U x.
inline void subtract_product(LaneVector6& v, const LaneBlock& u, const LaneVector6& x) {
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i)
#pragma GCC unroll 6
    for (int c = 0; c < 6; ++c) v[i] -= u[i][c] * x[c];
}

}  // namespace rodsweep
