// Eight doubles that the processor handles as one: the vector type behind the 6x6 block kernels.
//
// A column (or row) of a 6x6 block is one Lane8: six entries and two spare lanes. GCC and Clang lower the type to one
// AVX-512 register, two AVX or four SSE ones, so the same source is portable and fast.
#pragma once

#include <cmath>
#include <cstring>

#include "solver/numbers/types.hpp"

namespace rodsweep {

using Lane8 = double __attribute__((vector_size(64)));
using Lane4 = double __attribute__((vector_size(32)));  ///< a vector or quaternion

// The part of a Lane8 in one register of the processor.
#if defined(__AVX512F__)
inline constexpr int lane_width = 8;
#elif defined(__AVX__)
inline constexpr int lane_width = 4;
#else
inline constexpr int lane_width = 2;
#endif
inline constexpr int slices = 8 / lane_width;
using Lane = double __attribute__((vector_size(8 * lane_width)));

template <class Lanes>
inline double entry(const Lanes& value, int i) {
  return reinterpret_cast<const double*>(&value)[i];
}

/// One slice of a Lane8 or a Lane4; lanes beyond the four of a Lane4 are zero.
template <class Lanes, class Register = Lane>
inline Register slice_of(const Lanes& value, [[maybe_unused]] int slice) {
  if constexpr (sizeof(Register) > sizeof value) {
    return __builtin_shufflevector(value, Lanes{}, 0, 1, 2, 3, 4, 4, 4, 4);
  } else {
    Register out;
    std::memcpy(&out, reinterpret_cast<const Register*>(&value) + slice, sizeof out);
    return out;
  }
}
inline void set_slice(Lane8& value, int slice, const Lane& to) {
  std::memcpy(reinterpret_cast<Lane*>(&value) + slice, &to, sizeof to);
}

/// A 6x6 block: six columns (or six rows, if stated) of six entries and two zeros.
struct Block6 {
  Lane8 column[6];
};

inline Lane8 broadcast(double value) { return Lane8{value, value, value, value, value, value, value, value}; }

/// Lane i is one, the others zero.
inline constexpr Lane8 unit_lane[6] = {{1, 0, 0, 0, 0, 0, 0, 0}, {0, 1, 0, 0, 0, 0, 0, 0}, {0, 0, 1, 0, 0, 0, 0, 0},
                                       {0, 0, 0, 1, 0, 0, 0, 0}, {0, 0, 0, 0, 1, 0, 0, 0}, {0, 0, 0, 0, 0, 1, 0, 0}};

/// Six doubles from memory, the spare lanes zero.
inline Lane8 load6(const double* from) { return Lane8{from[0], from[1], from[2], from[3], from[4], from[5], 0, 0}; }

inline void store6(double* to, const Lane8& value) { std::memcpy(to, &value, 6 * sizeof(double)); }

/// Lane r of the result is the sum over all lanes of v[r], r < 6; the spare lanes are zero.
inline Lane8 sum_lanes(const Lane8 (&v)[6]) {
  // Three levels of pairwise sums, each halving the number of vectors and joining their partial sums.
  const auto pair = [](const Lane8& a, const Lane8& b) {
    return __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14) +
           __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
  };
  const Lane8 v01 = pair(v[0], v[1]), v23 = pair(v[2], v[3]), v45 = pair(v[4], v[5]);
  const Lane8 v0123 = __builtin_shufflevector(v01, v23, 0, 1, 8, 9, 4, 5, 12, 13) +
                      __builtin_shufflevector(v01, v23, 2, 3, 10, 11, 6, 7, 14, 15);
  const Lane8 zero{};
  const Lane8 v45zz = __builtin_shufflevector(v45, zero, 0, 1, 8, 8, 4, 5, 8, 8) +
                      __builtin_shufflevector(v45, zero, 2, 3, 8, 8, 6, 7, 8, 8);
  return __builtin_shufflevector(v0123, v45zz, 0, 1, 2, 3, 8, 9, 10, 11) +
         __builtin_shufflevector(v0123, v45zz, 4, 5, 6, 7, 12, 13, 14, 15);
}

// Vectors of three and quaternions in four lanes: (x, y, z, 0) and (x, y, z, w).

inline Lane4 lanes(const Quaternion& q) {
  Lane4 out;
  std::memcpy(&out, q.coeffs().data(), sizeof out);
  return out;
}

/// The cross product of the first three lanes; the fourth lane is zero.
inline Lane4 cross(const Lane4& a, const Lane4& b) {
  const Lane4 c = a * __builtin_shufflevector(b, b, 1, 2, 0, 3) - __builtin_shufflevector(a, a, 1, 2, 0, 3) * b;
  return __builtin_shufflevector(c, c, 1, 2, 0, 3);
}

inline double sum(const Lane8& v) { return ((v[0] + v[4]) + (v[1] + v[5])) + ((v[2] + v[6]) + (v[3] + v[7])); }
inline double sum(const Lane4& v) { return (v[0] + v[1]) + (v[2] + v[3]); }

// Quaternions are in memory: loading a single entry into all lanes costs nothing.

/// R(q) v.
inline Lane4 turned(const Quaternion& q, const Lane4& v) {
  const Lane4 axis = lanes(q), twice = 2 * cross(axis, v);
  return v + q.w() * twice + cross(axis, twice);
}

/// normalise(q + q [0, phi] / 2), rotation.hpp's rotated(q, R phi): phi in the segment's own frame.
inline Lane4 turned_within(const Quaternion& q, const Lane4& phi) {
  const Lane4 own = lanes(q), half = 0.5 * phi;
  Lane4 moved = own + q.w() * half + cross(own, half);
  moved[3] -= sum(own * half);
  return moved * (1 / std::sqrt(sum(moved * moved)));
}

}  // namespace rodsweep
