// The constraint of one joint (equations: linearization.hpp) for any number type T: a double for one joint, a Lane for
// as many as a register has lanes. Lengths are over l.
#pragma once

#include "solver/numbers/lane_math.hpp"

namespace rodsweep {

/// The joint's frame at rest, seen from its segments.
template <class T>
struct JointKink {
  Quad<T> frame_a, frame_b;   ///< p_a, p_b
  Triples<T> axes_a, axes_b;  ///< P_a, P_b

  void set_axes() {
    axes_a = rotation_matrix(frame_a);
    axes_b = rotation_matrix(frame_b);
  }
};

/// The constants of a joint.
template <class T>
struct JointShape {
  Triple<T> arm_a, arm_b;    ///< over l
  T inverse_length;          ///< 1/l [1/m]
  const JointKink<T>* kink;  ///< null: p_a = p_b = 1
};

/// e, taken with w >= 0, and another term of H.
template <class T>
struct JointTurn {
  Quad<T> e;
  T scale;  ///< 1 / (1 + w)
};

template <class T>
inline JointTurn<T> joint_turn(const Quad<T>& a, const Quad<T>& b, const JointShape<T>& shape) {
  Quad<T> e = relative(a, b);
  if (shape.kink) e = relative(shape.kink->frame_a, product(e, shape.kink->frame_b));
  e = in_hemisphere_of({T{} + 1, T{}, T{}, T{}}, e);
  return {e, 1 / (1 + e.w)};
}

/// H = R(e^(1/2)) = w I + [v]x + v v^T / (1 + w).
template <class T>
inline Triples<T> half_turn(const JointTurn<T>& turn) {
  const Quad<T>& e = turn.e;
  const Triple<T> v = {e.x, e.y, e.z}, scaled = turn.scale * v;
  const T xy = v.x * scaled.y, xz = v.x * scaled.z, yz = v.y * scaled.z;
  return {{e.w + v.x * scaled.x, xy + v.z, xz - v.y},
          {xy - v.z, e.w + v.y * scaled.y, yz + v.x},
          {xz + v.y, yz - v.x, e.w + v.z * scaled.z}};
}

/// From the joint's frame at rest to a segment's, R(p) v, and back, R(p)^T v.
template <class T>
inline Triple<T> to_a(const JointShape<T>& shape, const Triple<T>& v) {
  return shape.kink ? shape.kink->axes_a * v : v;
}
template <class T>
inline Triple<T> to_b(const JointShape<T>& shape, const Triple<T>& v) {
  return shape.kink ? shape.kink->axes_b * v : v;
}
template <class T>
inline Triple<T> from_a(const JointShape<T>& shape, const Triple<T>& v) {
  return shape.kink ? transposed_product(shape.kink->axes_a, v) : v;
}
template <class T>
inline Triple<T> from_b(const JointShape<T>& shape, const Triple<T>& v) {
  return shape.kink ? transposed_product(shape.kink->axes_b, v) : v;
}

/// C_s = H^T R(p_a)^T (R_a^T (x_a - x_b) + arm_a) - H R(p_b)^T arm_b, all over l; `apart` is x_a - x_b over l, in the
/// world.
template <class T>
inline Triple<T> stretch(const Triples<T>& half, const Quad<T>& a, const Triple<T>& apart, const JointShape<T>& shape) {
  return transposed_product(half, from_a(shape, conjugate(a) * apart + shape.arm_a)) -
         half * from_b(shape, shape.arm_b);
}

/// C_b = 2 Im(e).
template <class T>
inline Triple<T> bend(const JointTurn<T>& turn) {
  return {2 * turn.e.x, 2 * turn.e.y, 2 * turn.e.z};
}

/// dC_b of two segments that turn by phi, each in its own frame.
template <class T>
inline Triple<T> bend_change(const JointTurn<T>& turn, const JointShape<T>& shape, const Triple<T>& phi_a,
                             const Triple<T>& phi_b) {
  const Triple<T> a = from_a(shape, phi_a), b = from_b(shape, phi_b);
  return turn.e.w * (b - a) + cross(Triple<T>{turn.e.x, turn.e.y, turn.e.z}, a + b);
}

/// A force and a torque (or impulses) in a segment's frame.
template <class T>
struct Wrench {
  Triple<T> force, torque;
};

/// One for each segment of a joint.
template <class T>
struct Wrenches {
  Wrench<T> on_a, on_b;
};

/// J^T y; `half` is H, `stretch` and `bend` are y.
template <class T>
inline Wrenches<T> impulses(const JointTurn<T>& turn, const Triples<T>& half, const JointShape<T>& shape,
                            const Triple<T>& stretch, const Triple<T>& bend) {
  const Triple<T> on_a = to_a(shape, half * stretch), on_b = to_b(shape, transposed_product(half, stretch));
  const Triple<T> along = turn.e.w * bend, across = cross(Triple<T>{turn.e.x, turn.e.y, turn.e.z}, bend);
  return {{shape.inverse_length * on_a, cross(shape.arm_a, on_a) - to_a(shape, along + across)},
          {-shape.inverse_length * on_b, to_b(shape, along - across) - cross(shape.arm_b, on_b)}};
}

}  // namespace rodsweep
