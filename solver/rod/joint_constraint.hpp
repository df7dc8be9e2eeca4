// The constraint of one joint (equations: linearization.hpp) for any number type T: a double for one joint, a Lane for
// as many as a register has lanes. Lengths are over l.
#pragma once

#include <utility>

#include "solver/numbers/lane_math.hpp"

namespace rodsweep {

/// The constants of a joint.
template <class T>
struct JointShape {
  Quad<T> rest;            ///< d0
  Triple<T> arm_a, arm_b;  ///< over l
  T inverse_length;        ///< 1/l [1/m]
};

/// d and the other terms of H.
template <class T>
struct JointTurn {
  Quad<T> d;
  T scale;  ///< 1 / (1 + w)
};

template <class T>
inline JointTurn<T> joint_turn(const Quad<T>& a, const Quad<T>& b, const Quad<T>& rest) {
  const Quad<T> d = in_hemisphere_of(rest, relative(a, b));
  return {d, 1 / (1 + d.w)};
}

/// H = R(d^(1/2)) = w I + [v]x + v v^T / (1 + w).
template <class T>
inline Triples<T> half_turn(const JointTurn<T>& turn) {
  const Quad<T>& d = turn.d;
  const Triple<T> v = {d.x, d.y, d.z}, scaled = turn.scale * v;
  const T xy = v.x * scaled.y, xz = v.x * scaled.z, yz = v.y * scaled.z;
  return {{d.w + v.x * scaled.x, xy + v.z, xz - v.y},
          {xy - v.z, d.w + v.y * scaled.y, yz + v.x},
          {xz + v.y, yz - v.x, d.w + v.z * scaled.z}};
}

/// C_s = H^T ((R_a^T (x_a - x_b) + arm_a) - H arm_b, all over l; `apart` is x_a - x_b over l, in the world.
template <class T>
inline Triple<T> stretch(const Triples<T>& half, const Quad<T>& a, const Triple<T>& apart, const JointShape<T>& shape) {
  return transposed_product(half, conjugate(a) * apart + shape.arm_a) - half * shape.arm_b;
}

/// C_b = 2 Im(d) - 2 Im(d0).
template <class T>
inline Triple<T> bend(const Quad<T>& d, const Quad<T>& rest) {
  return {2 * (d.x - rest.x), 2 * (d.y - rest.y), 2 * (d.z - rest.z)};
}

/// A force and a torque (or impulses) in a segment's frame.
template <class T>
struct Wrench {
  Triple<T> force, torque;
};

/// J^T y on the segments of a joint. y's stretch-shear rows are `on_b` in the frame of the second segment, and `on_a`,
/// R(d) on_b, in the frame of the first.
template <class T>
inline std::pair<Wrench<T>, Wrench<T>> impulses(const Quad<T>& d, const JointShape<T>& shape, const Triple<T>& on_a,
                                                const Triple<T>& on_b, const Triple<T>& bend) {
  const Triple<T> along = d.w * bend, across = cross(Triple<T>{d.x, d.y, d.z}, bend);
  return {{shape.inverse_length * on_a, cross(shape.arm_a, on_a) - along - across},
          {-shape.inverse_length * on_b, along - across - cross(shape.arm_b, on_b)}};
}

}  // namespace rodsweep
