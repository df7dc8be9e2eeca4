// Vectors of three and quaternions in four lanes: (x, y, z, 0) and (x, y, z, w).
#pragma once

#include <cmath>
#include <cstring>

#include "solver/numbers/lanes.hpp"

namespace rodsweep {

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
