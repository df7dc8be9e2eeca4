// 6x6 blocks of inference in single precision: a register of sixteen lanes holds two columns of six numbers, in lanes
// 0..5 and 8..13, or one vector twice.
#pragma once

#include <cstring>
#include <type_traits>

#include "network/encoding/canonical_frames.hpp"
#include "network/layers/float_lanes.hpp"
#include "solver/numbers/lanes.hpp"

namespace rodsweep::lane16 {

using Lane16 = float __attribute__((vector_size(64)));

inline Lane16 load16(const float* from) {
  Lane16 out;
  std::memcpy(&out, from, sizeof out);
  return out;
}

/// Lane I of `v` in the whole lower half, lane J in the upper half.
template <int I, int J>
Lane16 spread(const Lane16& v) {
  return __builtin_shufflevector(v, v, I, I, I, I, I, I, I, I, J, J, J, J, J, J, J, J);
}

template <int R>
using Row = std::integral_constant<int, R>;

using Lane8Float = float __attribute__((vector_size(32)));

inline Lane16 halves(const Lane8Float& low, const Lane8Float& high) {
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

inline Lane16 twice(const Lane8& v) {
  const Lane8Float once = __builtin_convertvector(v, Lane8Float);
  return halves(once, once);
}

/// P = T S of a joint, in both halves, and its products with pairs of columns.
struct ScaledFrame {
  Lane16 along, across;

  ScaledFrame(const CanonicalFrames& frames, int place)
      : along(twice(frames.scale(place) * frames.frame(place).along)),
        across(twice(frames.scale(place) * frames.frame(place).across)) {}

  /// `v` with x and y of both transverse pairs exchanged.
  static Lane16 exchanged(const Lane16& v) {
    return __builtin_shufflevector(v, v, 1, 0, 2, 4, 3, 5, 6, 7, 9, 8, 10, 12, 11, 13, 14, 15);
  }
  Lane16 apply(const Lane16& v) const { return along * v + across * exchanged(v); }
  Lane16 transposed(const Lane16& v) const { return along * v + exchanged(across * v); }
  /// Sets `other` to the columns of `m` with x and y exchanged.
  static void exchange_columns(const Lane16 (&m)[3], Lane16 (&other)[3]) {
    other[0] = __builtin_shufflevector(m[0], m[0], 8, 9, 10, 11, 12, 13, 14, 15, 0, 1, 2, 3, 4, 5, 6, 7);
    other[1] = __builtin_shufflevector(m[1], m[2], 0, 1, 2, 3, 4, 5, 6, 7, 16, 17, 18, 19, 20, 21, 22, 23);
    other[2] = __builtin_shufflevector(m[1], m[2], 8, 9, 10, 11, 12, 13, 14, 15, 24, 25, 26, 27, 28, 29, 30, 31);
  }
  /// M <- P^T M P.
  void around(Lane16 (&m)[3]) const {
    Lane16 other[3];
    exchange_columns(m, other);
    const Lane16 of_other = exchanged(across);
    m[0] = transposed(spread<0, 1>(along) * m[0] + spread<0, 1>(of_other) * other[0]);
    m[1] = transposed(spread<2, 3>(along) * m[1] + spread<2, 3>(of_other) * other[1]);
    m[2] = transposed(spread<4, 5>(along) * m[2] + spread<4, 5>(of_other) * other[2]);
  }
  /// M <- P M P_column^T.
  void see(const ScaledFrame& column, Lane16 (&m)[3]) const {
    for (Lane16& pair : m) pair = apply(pair);
    Lane16 other[3];
    exchange_columns(m, other);
    m[0] = spread<0, 1>(column.along) * m[0] + spread<0, 1>(column.across) * other[0];
    m[1] = spread<2, 3>(column.along) * m[1] + spread<2, 3>(column.across) * other[1];
    m[2] = spread<4, 5>(column.along) * m[2] + spread<4, 5>(column.across) * other[2];
  }
};

/// A block in single precision.
inline void narrowed(const Block6& block, Lane16 (&m)[3]) {
  for (int q = 0; q < 3; ++q)
    m[q] = halves(__builtin_convertvector(block.column[2 * q], Lane8Float),
                  __builtin_convertvector(block.column[2 * q + 1], Lane8Float));
}

/// Stores 36 entries, column by column; writes two more beyond them.
inline void put_columns(const Lane16 (&m)[3], float* to) {
  for (int q = 0; q < 3; ++q) {
    const Lane8Float first = __builtin_shufflevector(m[q], m[q], 0, 1, 2, 3, 4, 5, 6, 7),
                     second = __builtin_shufflevector(m[q], m[q], 8, 9, 10, 11, 12, 13, 14, 15);
    std::memcpy(to + 12 * q, &first, sizeof first);
    std::memcpy(to + 12 * q + 6, &second, sizeof second);
  }
}
inline void take_columns(const float* from, Lane16 (&m)[3]) {
  for (int q = 0; q < 3; ++q) {
    Lane8Float first, second;
    std::memcpy(&first, from + 12 * q, sizeof first);
    std::memcpy(&second, from + 12 * q + 6, sizeof second);
    m[q] = halves(first, second);
  }
}

/// A v in both halves; v is in lanes 0..5.
inline Lane16 times(const Lane16 (&a)[3], const Lane16& v) {
  const Lane16 sum = a[0] * spread<0, 1>(v) + a[1] * spread<2, 3>(v) + a[2] * spread<4, 5>(v);
  return sum + __builtin_shufflevector(sum, sum, 8, 9, 10, 11, 12, 13, 14, 15, 0, 1, 2, 3, 4, 5, 6, 7);
}

/// Columns I and J of a symmetric matrix whose lower triangle, by columns, is in lanes 0..15 of `first` and in those of
/// `last` from Rest - 16 on.
template <int I, int J, int Rest>
Lane16 columns(const Lane16& first, const Lane16& last) {
  // Entry (r, c), r >= c, is number c (11 - c) / 2 + r of the triangle.
#define RODSWEEP_ENTRY(r, c)                                                                                     \
  ((r) >= (c)                                                                                                    \
       ? ((c) * (11 - (c)) / 2 + (r) < 16 ? (c) * (11 - (c)) / 2 + (r) : (c) * (11 - (c)) / 2 + (r) + Rest - 16) \
       : ((r) * (11 - (r)) / 2 + (c) < 16 ? (r) * (11 - (r)) / 2 + (c) : (r) * (11 - (r)) / 2 + (c) + Rest - 16))
#define RODSWEEP_COLUMN(c)                                                                                      \
  RODSWEEP_ENTRY(0, c), RODSWEEP_ENTRY(1, c), RODSWEEP_ENTRY(2, c), RODSWEEP_ENTRY(3, c), RODSWEEP_ENTRY(4, c), \
      RODSWEEP_ENTRY(5, c), 0, 0
  return __builtin_shufflevector(first, last, RODSWEEP_COLUMN(I), RODSWEEP_COLUMN(J));
#undef RODSWEEP_COLUMN
#undef RODSWEEP_ENTRY
}

/// Two columns of T B: `t` T's columns, each in both halves; `b` two columns of B.
inline Lane16 product(const Lane16 (&t)[6], const Lane16& b) {
  const auto entries = [&](auto row) {
    constexpr int r = decltype(row)::value;
    return t[r] * spread<r, 8 + r>(b);
  };
  return (entries(Row<0>{}) + entries(Row<1>{})) + (entries(Row<2>{}) + entries(Row<3>{})) +
         (entries(Row<4>{}) + entries(Row<5>{}));
}

/// Rows R and R + 1 of a matrix given by pairs of columns.
template <int R>
Lane16 rows(const Lane16 (&m)[3]) {
  constexpr int S = R + 1;
  const Lane16 four =
      __builtin_shufflevector(m[0], m[1], R, 8 + R, 16 + R, 24 + R, 0, 0, 0, 0, S, 8 + S, 16 + S, 24 + S, 0, 0, 0, 0);
  return __builtin_shufflevector(four, m[2], 0, 1, 2, 3, 16 + R, 24 + R, 0, 0, 8, 9, 10, 11, 16 + S, 24 + S, 0, 0);
}

inline void transpose(const Lane16 (&m)[3], Lane16 (&out)[3]) {
  out[0] = rows<0>(m);
  out[1] = rows<2>(m);
  out[2] = rows<4>(m);
}

inline FloatLane larger(const FloatLane& a, float b) { return a > b ? a : broadcast_lane(b); }

/// ramp(a) (network/layers/ramp.hpp).
inline FloatLane ramp(const FloatLane& a) {
  const FloatLane t = larger(a, -1) * 0.5F + 0.5F, half = t < 1.F ? t : broadcast_lane(1);
  return half * half + larger(a - 1.F, 0);
}

}  // namespace rodsweep::lane16
