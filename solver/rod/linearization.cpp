#include "solver/rod/linearization.hpp"

#include "solver/numbers/lane_vectors.hpp"

namespace rodsweep {
namespace {

/// Lanes 0..3 of four, the others zero.
inline Lane8 widened(const Lane4& v) { return __builtin_shufflevector(v, Lane4{}, 0, 1, 2, 3, 4, 4, 4, 4); }

/// The columns of w I and [v]x, d = (v, w), which permute d, in lanes 0..2 and in lanes 3..5.
struct TurnColumns {
  Lane4 low[3];
  Lane8 high[3];

  explicit TurnColumns(const Lane4& d)
      : low{__builtin_shufflevector(d, d, 3, 2, 1, 0), __builtin_shufflevector(d, d, 2, 3, 0, 1),
            __builtin_shufflevector(d, d, 1, 0, 3, 2)},
        high{__builtin_shufflevector(d, d, 3, 3, 3, 3, 2, 1, 0, 0),
             __builtin_shufflevector(d, d, 2, 2, 2, 2, 3, 0, 1, 1),
             __builtin_shufflevector(d, d, 1, 1, 1, 1, 0, 3, 2, 2)} {}
};

// Their signs in w I + [v]x (forth) and [v]x - w I (back).
constexpr Lane4 forth_low[3] = {{1, 1, -1, 0}, {-1, 1, 1, 0}, {1, -1, 1, 0}};
constexpr Lane4 back_low[3] = {{-1, 1, -1, 0}, {-1, -1, 1, 0}, {1, -1, -1, 0}};
constexpr Lane8 forth_high[3] = {{0, 0, 0, 1, 1, -1}, {0, 0, 0, -1, 1, 1}, {0, 0, 0, 1, -1, 1}};
constexpr Lane8 back_high[3] = {{0, 0, 0, -1, 1, -1}, {0, 0, 0, -1, -1, 1}, {0, 0, 0, 1, -1, -1}};

inline Lane4 product(const Lane4 (&m)[3], const Lane4& v) { return m[0] * v[0] + m[1] * v[1] + m[2] * v[2]; }
inline Lane4 product(const Lane4 (&m)[3], const Vector3& v) { return m[0] * v[0] + m[1] * v[1] + m[2] * v[2]; }

/// The columns of -M [v]x.
inline void product_with_cross(const Lane4 (&m)[3], const Vector3& v, Lane4 (&column)[3]) {
  column[0] = v[1] * m[2] - v[2] * m[1];
  column[1] = v[2] * m[0] - v[0] * m[2];
  column[2] = v[0] * m[1] - v[1] * m[0];
}

/// d of a joint, in the hemisphere of d0.
inline Lane4 turn_of(const Rod& rod, const Joint& joint) {
  const Lane4 d =
      relative(rod.orientation[static_cast<std::size_t>(joint.a)], rod.orientation[static_cast<std::size_t>(joint.b)]);
  return sum(d * lanes(joint.rest)) < 0 ? -d : d;
}

inline void evaluate(const Rod& rod, const Joint& joint, JointJacobian& jacobian, double* constraint) {
  const std::size_t a = static_cast<std::size_t>(joint.a), b = static_cast<std::size_t>(joint.b);
  const Lane4 d = turn_of(rod, joint);
  const double inverse_length = 1 / joint.length;
  const TurnColumns turn(d);
  const Lane4 v = d * Lane4{1, 1, 1, 0}, scaled = v * (inverse_length / (1 + d[3]));
  for (int c = 0; c < 3; ++c) {
    const Lane4 outer = scaled * v[c], column = inverse_length * turn.low[c];
    jacobian.shift_a[c] = outer - back_low[c] * column;
    jacobian.shift_b[c] = -outer - forth_low[c] * column;
  }

  const Lane4 apart = turned_back(rod.orientation[a], lanes(rod.position[a] - rod.position[b]));
  const Lane4 stretch = product(jacobian.shift_a, apart) + product(jacobian.shift_a, joint.arm_a) +
                        product(jacobian.shift_b, joint.arm_b);
  const Lane4 bend = 2 * (d - lanes(joint.rest));
  store6(constraint, __builtin_shufflevector(stretch, bend, 0, 1, 2, 4, 5, 6, 3, 3));

  Lane4 across_a[3], across_b[3];
  product_with_cross(jacobian.shift_a, joint.arm_a, across_a);
  product_with_cross(jacobian.shift_b, joint.arm_b, across_b);
  for (int c = 0; c < 3; ++c) {
    jacobian.rotation_a[c] = widened(across_a[c]) + back_high[c] * turn.high[c];
    jacobian.rotation_b[c] = widened(across_b[c]) + forth_high[c] * turn.high[c];
  }
  jacobian.inverse_length = inverse_length;
}

}  // namespace

Linearization::Linearization(const Rod& rod)
    : joints(rod.joints.size()), constraint(VectorX::Zero(6 * rod.joint_count())) {}

Quaternion relative_turn(const Rod& rod, const Joint& joint) {
  const Lane4 d = turn_of(rod, joint);
  return Quaternion(d[3], d[0], d[1], d[2]);
}

Vector3 to_world(const Rod& rod, const Joint& joint, const Vector3& in_joint_frame) {
  const Lane4 d = turn_of(rod, joint), v = d * Lane4{1, 1, 1, 0}, local = lanes(in_joint_frame);
  const Lane4 own = d[3] * local + cross(d, local) + v * (sum(v * local) / (1 + d[3]));
  const Lane4 out = turned(rod.orientation[static_cast<std::size_t>(joint.a)], own);
  return {out[0], out[1], out[2]};
}

void linearize(const Rod& rod, const Joint& joint, JointJacobian& jacobian, double* constraint) {
  evaluate(rod, joint, jacobian, constraint);
}

void linearize(const Rod& rod, Linearization& out) {
  for (std::size_t k = 0; k < rod.joints.size(); ++k)
    evaluate(rod, rod.joints[k], out.joints[k], out.constraint.data() + 6 * k);
}

}  // namespace rodsweep
