// Kernels of a condensation (condensation.hpp): the blocks J^T C J' of joints, one joint per lane.
#pragma once

#include <algorithm>

#include "solver/numbers/lane_blocks.hpp"
#include "solver/rod/joint_kernels.hpp"

namespace rodsweep {

/// A side of a joint in each lane: dC_s/du and dC/dphi by columns.
struct LaneSide {
  Lane shift[3][3], rotation[3][6];

  void set(int lane, const JointSide& side) {
    for (int j = 0; j < 3; ++j) {
      for (int r = 0; r < 3; ++r) shift[j][r][lane] = side.shift[j][r];
      for (int r = 0; r < 6; ++r) rotation[j][r][lane] = side.rotation[j][r];
    }
  }
};

/// A column of C J: its first `rows` entries; the others are zero.
template <int rows>
struct Weighted {
  Lane row[rows];
};

template <int rows>
Lane dot(const Lane* column, const Weighted<rows>& weighted) {
  Lane sum = column[0] * weighted.row[0];
#pragma GCC unroll 6
  for (int r = 1; r < rows; ++r) sum += column[r] * weighted.row[r];
  return sum;
}

template <int rows>
Weighted<rows> weighted(const Lane (&c)[6], const Lane* column) {
  Weighted<rows> out;
#pragma GCC unroll 6
  for (int r = 0; r < rows; ++r) out.row[r] = c[r] * column[r];
  return out;
}

/// A column of J^T C J' from `column`, the same column of C J': calls entry(i, value) for the rows i.
template <int rows, class Entry>
void put_column(const LaneSide& side, const Weighted<rows>& column, int first_row, const Entry& entry) {
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i)
    if (i >= first_row)
      entry(i, i < 3 ? dot<3>(side.shift[i], Weighted<3>{column.row[0], column.row[1], column.row[2]})
                     : dot<rows>(side.rotation[i - 3], column));
}

/// out = J^T C J', by columns.
inline void product(const LaneSide& side, const Lane (&c)[6], const LaneSide& other, LaneVector6 (&out)[6]) {
#pragma GCC unroll 1
  for (int j = 0; j < 3; ++j) {
    put_column(side, weighted<3>(c, other.shift[j]), 0, [&](int i, const Lane& value) { out[j][i] = value; });
    put_column(side, weighted<6>(c, other.rotation[j]), 0, [&](int i, const Lane& value) { out[3 + j][i] = value; });
  }
}

/// out += J^T C J.
inline void add_square(const LaneSide& side, const Lane (&c)[6], LaneBlock& out) {
#pragma GCC unroll 3
  for (int j = 0; j < 3; ++j) {
    put_column(side, weighted<3>(c, side.shift[j]), j, [&](int i, const Lane& value) { out[i][j] += value; });
    put_column(side, weighted<6>(c, side.rotation[j]), 3 + j,
               [&](int i, const Lane& value) { out[i][3 + j] += value; });
  }
}

/// Joints between two segments, one in each lane, with their stiffness C.
struct LaneJoint {
  Lane c[6];
  LaneSide before, after;

  void set(int lane, const JointJacobian& jacobian, bool b_is_before, const Lane8& stiffness) {
    for (int i = 0; i < 6; ++i) c[i][lane] = stiffness[i];
    before.set(lane, JointSide(jacobian, b_is_before));
    after.set(lane, JointSide(jacobian, !b_is_before));
  }
  void clear(int lane) {
    for (Lane& stiffness : c) stiffness[lane] = 0;
  }
};

/// A symmetric block of one lane, by columns.
inline void add_symmetric(const LaneBlock& from, int lane, Block6& to) {
  for (int c = 0; c < 6; ++c)
    for (int r = 0; r < 6; ++r) to.column[c][r] += from[std::max(r, c)][std::min(r, c)][lane];
}
inline void add_columns(const LaneVector6 (&columns)[6], int lane, Block6& to) {
  for (int c = 0; c < 6; ++c)
    for (int r = 0; r < 6; ++r) to.column[c][r] += columns[c][r][lane];
}
inline void add_transposed(const LaneVector6 (&columns)[6], int lane, Block6& to) {
  for (int c = 0; c < 6; ++c)
    for (int r = 0; r < 6; ++r) to.column[r][c] += columns[c][r][lane];
}

/// f_to -= (columns)^T f.
inline void subtract_transposed(const LaneVector6 (&columns)[6], const LaneVector6& f, LaneVector6& to) {
#pragma GCC unroll 6
  for (int c = 0; c < 6; ++c)
#pragma GCC unroll 6
    for (int r = 0; r < 6; ++r) to[c] -= columns[c][r] * f[r];
}

}  // namespace rodsweep
