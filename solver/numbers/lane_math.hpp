// Vectors and quaternions of as many segments as a register has lanes, one segment per lane (lane_records.hpp).
// Functions that single joints use as well are templates of the number type T, a double or a Lane.
//
// The rotation maps are those of rotation.hpp.
#pragma once

#include <Eigen/Core>

#include "solver/numbers/lanes.hpp"

namespace rodsweep {

using LaneMask = decltype(Lane{} < Lane{});  ///< every bit of a lane set, or none

template <class T>
struct Triple {
  T x, y, z;
};

template <class T>
struct Quad {
  T w, x, y, z;
};

/// A 3x3 matrix by its columns.
template <class T>
struct Triples {
  Triple<T> x, y, z;
};

using LaneVector = Triple<Lane>;
using LaneQuaternion = Quad<Lane>;
using LaneMatrix = Triples<Lane>;

template <class T>
inline Triple<T> operator+(const Triple<T>& a, const Triple<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
inline Triple<T> operator-(const Triple<T>& a, const Triple<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
inline Triple<T> operator-(const Triple<T>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class T>
inline Triple<T> operator*(const T& s, const Triple<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
inline T dot(const Triple<T>& a, const Triple<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
inline Triple<T> cross(const Triple<T>& a, const Triple<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Per lane `where` ? a : b; the other one may be NaN.
inline LaneVector select(const LaneMask& where, const LaneVector& a, const LaneVector& b) {
  return {where ? a.x : b.x, where ? a.y : b.y, where ? a.z : b.z};
}
inline LaneQuaternion select(const LaneMask& where, const LaneQuaternion& a, const LaneQuaternion& b) {
  return {where ? a.w : b.w, where ? a.x : b.x, where ? a.y : b.y, where ? a.z : b.z};
}

inline Lane all_lanes(double value) { return Lane{} + value; }
inline LaneVector all_lanes(const Vector3& v) { return {all_lanes(v.x()), all_lanes(v.y()), all_lanes(v.z())}; }

inline Lane absolute(const Lane& value) { return value < 0 ? -value : value; }

/// cos(2 pi t), to 1e-13: the sine series of 2 pi (1/4 - |t - round(t)|).
inline Lane cosine_of_turns(const Lane& t) {
  constexpr double whole = 0x1.8p52;  // adding it removes the fraction
  const Lane angle = 2 * pi * (0.25 - absolute(t - ((t + whole) - whole)));
  Lane sum{};
  for (int n = 19; n > 1; n -= 2) sum = -angle * angle / (n * (n - 1)) * (1 + sum);
  return angle * (1 + sum);
}

inline Lane square_root(Lane value) {
  Eigen::Map<Eigen::Array<double, lane_width, 1>, sizeof(Lane)> entries(reinterpret_cast<double*>(&value));
  entries = entries.sqrt();
  return value;
}

template <class T>
inline T dot(const Quad<T>& a, const Quad<T>& b) {
  return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
inline Quad<T> operator*(const T& s, const Quad<T>& q) {
  return {s * q.w, s * q.x, s * q.y, s * q.z};
}

/// q or -q, the one in the hemisphere of `pole`.
template <class T>
inline Quad<T> in_hemisphere_of(const Quad<T>& pole, const Quad<T>& q) {
  const T sign = dot(pole, q) < 0 ? T{} - 1 : T{} + 1;
  return sign * q;
}

/// conj(a) b.
template <class T>
inline Quad<T> relative(const Quad<T>& a, const Quad<T>& b) {
  return {dot(a, b), a.w * b.x - a.x * b.w - a.y * b.z + a.z * b.y, a.w * b.y - a.y * b.w - a.z * b.x + a.x * b.z,
          a.w * b.z - a.z * b.w - a.x * b.y + a.y * b.x};
}

template <class T>
inline Quad<T> product(const Quad<T>& a, const Quad<T>& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y + a.y * b.w + a.z * b.x - a.x * b.z, a.w * b.z + a.z * b.w + a.x * b.y - a.y * b.x};
}

/// normalise(q + [0, theta] q / 2).
inline LaneQuaternion rotated(const LaneQuaternion& q, const LaneVector& theta) {
  const LaneVector h = all_lanes(0.5) * theta;
  const LaneQuaternion turned = {q.w - h.x * q.x - h.y * q.y - h.z * q.z, q.x + h.x * q.w + h.y * q.z - h.z * q.y,
                                 q.y + h.y * q.w + h.z * q.x - h.x * q.z, q.z + h.z * q.w + h.x * q.y - h.y * q.x};
  return 1 / square_root(dot(turned, turned)) * turned;
}

/// 2 Im(d) / Re(d), d = q conj(q_old).
inline LaneVector rotation(const LaneQuaternion& q, const LaneQuaternion& old) {
  const LaneVector imaginary = {q.x * old.w - q.w * old.x - q.y * old.z + q.z * old.y,
                                q.y * old.w - q.w * old.y - q.z * old.x + q.x * old.z,
                                q.z * old.w - q.w * old.z - q.x * old.y + q.y * old.x};
  return 2 / dot(q, old) * imaginary;
}

/// R(q) v.
template <class T>
inline Triple<T> operator*(const Quad<T>& q, const Triple<T>& v) {
  const Triple<T> axis = {q.x, q.y, q.z}, across = cross(axis, v), twice = across + across;
  return v + q.w * twice + cross(axis, twice);
}

template <class T>
inline Quad<T> conjugate(const Quad<T>& q) {
  return {q.w, -q.x, -q.y, -q.z};
}

/// w - f (t . w) w x t: the spin of an axisymmetric body after gyroscopic torque, explicitly; t its axis.
inline LaneVector gyrated(const LaneVector& w, const LaneVector& axis, const Lane& f) {
  return w - (f * dot(axis, w)) * cross(w, axis);
}

/// A segment's local z in the world.
inline LaneVector director(const LaneQuaternion& q) {
  return {2 * (q.x * q.z + q.w * q.y), 2 * (q.y * q.z - q.w * q.x), 1 - 2 * (q.x * q.x + q.y * q.y)};
}

/// R(q).
template <class T>
inline Triples<T> rotation_matrix(const Quad<T>& q) {
  const T x = 2 * q.x, y = 2 * q.y, z = 2 * q.z, one = T{} + 1;
  const T wx = q.w * x, wy = q.w * y, wz = q.w * z;
  const T xx = q.x * x, yy = q.y * y, zz = q.z * z, xy = q.x * y, xz = q.x * z, yz = q.y * z;
  return {{one - yy - zz, xy + wz, xz - wy}, {xy - wz, one - xx - zz, yz + wx}, {xz + wy, yz - wx, one - xx - yy}};
}

template <class T>
inline Triple<T> operator*(const Triples<T>& m, const Triple<T>& v) {
  return v.x * m.x + v.y * m.y + v.z * m.z;
}
template <class T>
inline Triple<T> transposed_product(const Triples<T>& m, const Triple<T>& v) {
  return {dot(m.x, v), dot(m.y, v), dot(m.z, v)};
}

}  // namespace rodsweep
