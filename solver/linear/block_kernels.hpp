// Kernels on 6x6 blocks whose rows are lanes, with right-hand sides in the spare lane 6: the factors of a symmetric
// S = L D L^T, and S^-1 B in its two halves,
//   W = L^-1 B     and     L^-T D^-1 W.
//
// Pivots are computed in pairs, the second as the determinant of both over the first, so that it does not depend on the
// first division. The kernels process one register's columns after the other (Lane): six rows of a slice and a
// broadcast factor fit into the registers of any processor.
#pragma once

#include <algorithm>

#include "solver/numbers/lanes.hpp"

namespace rodsweep {

/// `value` with lane 6 of `from`.
inline Lane8 with_lane_6(const Lane8& value, const Lane8& from) {
  return __builtin_shufflevector(value, from, 0, 1, 2, 3, 4, 5, 14, 7);
}

/// `value` in lane 6, the others zero.
inline Lane8 in_lane_6(double value) { return Lane8{0, 0, 0, 0, 0, 0, value, 0}; }

/// L below its diagonal of ones and 1 / D, every entry in all lanes.
struct RowFactor {
  Lane l[6][6];
  Lane inverse_pivot[6];
};

/// One slice of the six rows of a block.
struct RowSlice {
  Lane row[6];

  RowSlice(const Block6& rows, int slice) {
#pragma GCC unroll 6
    for (int r = 0; r < 6; ++r) row[r] = slice_of(rows.column[r], slice);
  }
  /// Copies lane 6 into the slice that contains it.
  void take_lane_6(const Block6& rows) {
    const auto lane_6 = slice_of(in_lane_6(1), 6 / lane_width) > 0;
#pragma GCC unroll 6
    for (int r = 0; r < 6; ++r) row[r] = lane_6 ? slice_of(rows.column[r], 6 / lane_width) : row[r];
  }
  void store(Block6& rows, int slice) const {
#pragma GCC unroll 6
    for (int r = 0; r < 6; ++r) set_slice(rows.column[r], slice, row[r]);
  }
};

/// b <- L^-1 b, with the first `columns` columns of L.
inline void forward(const RowFactor& factor, RowSlice& b, int columns = 6) {
#pragma GCC unroll 6
  for (int j = 0; j < columns; ++j)
#pragma GCC unroll 6
    for (int k = j + 1; k < 6; ++k) b.row[k] -= factor.l[k][j] * b.row[j];
}

/// b <- D^-1 b.
inline void divide(const RowFactor& factor, RowSlice& b) {
#pragma GCC unroll 6
  for (int j = 0; j < 6; ++j) b.row[j] *= factor.inverse_pivot[j];
}

/// b <- L^-T b.
inline void backward(const RowFactor& factor, RowSlice& b) {
#pragma GCC unroll 6
  for (int j = 5; j > 0; --j)
#pragma GCC unroll 6
    for (int k = 0; k < j; ++k) b.row[k] -= factor.l[j][k] * b.row[j];
}

/// The factors of S; s <- L^-1 s. Returns false at a pivot that is not positive, or if the last one is NaN.
inline bool decompose(Block6& s, RowFactor& out) {
  double smallest = 1;
#pragma GCC unroll 4
  for (int p = 0; p < slices; ++p) {
    RowSlice rows(s, p);
    Lane(&row)[6] = rows.row;
    const int begin = std::min(6, p * lane_width), end = std::min(6, begin + lane_width);
    forward(out, rows, begin);
#pragma GCC unroll 3
    for (int j = begin; j < end; j += 2) {
      const int lane = j - begin;
      const double first = row[j][lane], across = row[j + 1][lane];
      const double determinant = first * row[j + 1][lane + 1] - across * across;
      smallest = smallest < first ? smallest : first;
      smallest = smallest < determinant ? smallest : determinant;
      out.inverse_pivot[j] = Lane{} + 1 / first;
      out.inverse_pivot[j + 1] = Lane{} + first / determinant;
#pragma GCC unroll 2
      for (int c = j; c < j + 2; ++c)
#pragma GCC unroll 6
        for (int k = c + 1; k < 6; ++k) {
          out.l[k][c] = (Lane{} + row[k][c - begin]) * out.inverse_pivot[c];
          row[k] -= out.l[k][c] * row[c];
        }
    }
    rows.store(s, p);
  }
  return smallest > 0;
}

/// S^-1 b from the rows L^-1 S of decompose(), with b in lane 6.
inline Lane8 solution(const RowFactor& factor, const Block6& s) {
  constexpr int slice = 6 / lane_width, lane = 6 % lane_width;
  RowSlice rows(s, slice);
  divide(factor, rows);
  backward(factor, rows);
  return Lane8{rows.row[0][lane], rows.row[1][lane], rows.row[2][lane],
               rows.row[3][lane], rows.row[4][lane], rows.row[5][lane]};
}

/// target <- from - B^T X over the rows of B and X.
inline void subtract_product(const Block6& from, const Block6& b, const Block6& x, Block6& target) {
#pragma GCC unroll 4
  for (int p = 0; p < slices; ++p) {
    const RowSlice slice(x, p);
#pragma GCC unroll 6
    for (int r = 0; r < 6; ++r) {
      Lane row = slice_of(from.column[r], p);
#pragma GCC unroll 6
      for (int j = 0; j < 6; ++j) row -= reinterpret_cast<const double*>(&b.column[j])[r] * slice.row[j];
      set_slice(target.column[r], p, row);
    }
  }
}

/// b <- S^-1 b on the rows of b.
inline void solve_rows(const RowFactor& factor, Block6& b) {
#pragma GCC unroll 4
  for (int p = 0; p < slices; ++p) {
    RowSlice rows(b, p);
    forward(factor, rows);
    divide(factor, rows);
    backward(factor, rows);
    rows.store(b, p);
  }
}

}  // namespace rodsweep
