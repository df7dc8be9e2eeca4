// What one joint contributes to A = J M^-1 J^T and to M^-1 J^T dlambda, in lanes: six rows of C, or one segment's
// (u, phi) in lanes 0..2 and 3..5. In the segments' own frames M is diagonal.
#pragma once

#include "solver/rod/linearization.hpp"

namespace rodsweep {

/// Three lanes and zeros.
inline Lane8 widened(const Lane4& v) { return __builtin_shufflevector(v, Lane4{}, 0, 1, 2, 4, 4, 4, 4, 4); }

/// One side of a joint.
struct JointSide {
  const Lane8* rotation;  ///< columns of dC/dphi
  const Lane4* shift;     ///< of dC_s/du
  double inverse_length;

  JointSide(const JointJacobian& jacobian, bool is_b)
      : rotation(is_b ? jacobian.rotation_b : jacobian.rotation_a),
        shift(is_b ? jacobian.shift_b : jacobian.shift_a),
        inverse_length(jacobian.inverse_length) {}
};

/// J M^-1 of one side and its segment.
class WeightedSide {
 public:
  WeightedSide(const JointSide& side, const Segment& segment) : side_(side), inverse_mass_(segment.inverse_mass) {
    const double transverse = segment.inverse_inertia_transverse;
    rotation_[0] = side.rotation[0] * transverse;
    rotation_[1] = side.rotation[1] * transverse;
    rotation_[2] = side.rotation[2] * segment.inverse_inertia_axial;
  }

  /// Columns of J M^-1 J^T with the same side; these are its rows as well.
  void times_itself(Lane8 (&column)[6]) const {
    turning(side_.rotation, column);
    const double shifting = inverse_mass_ * side_.inverse_length * side_.inverse_length;  // H is orthogonal
    for (int c = 0; c < 3; ++c) column[c] += unit_lane[c] * shifting;
  }

  /// Columns of J M^-1 J'^T with another joint's side on the same segment.
  void times(const JointSide& other, Lane8 (&column)[6]) const {
    turning(other.rotation, column);
    for (int j = 0; j < 3; ++j) {
      const Lane8 shift = widened(inverse_mass_ * side_.shift[j]);
      for (int c = 0; c < 3; ++c) column[c] += shift * other.shift[j][c];
    }
  }

 private:
  void turning(const Lane8* other, Lane8 (&column)[6]) const {
    for (int c = 0; c < 6; ++c)
      column[c] = rotation_[0] * other[0][c] + rotation_[1] * other[1][c] + rotation_[2] * other[2][c];
  }

  const JointSide& side_;
  double inverse_mass_;
  Lane8 rotation_[3];
};

/// J^T dlambda of one joint: the impulses on its two segments.
inline void impulses(const JointJacobian& jacobian, const Lane8& multiplier, Lane8& on_a, Lane8& on_b) {
  Lane8 terms[6];
  for (int c = 0; c < 3; ++c) terms[c] = jacobian.rotation_a[c] * multiplier;
  for (int c = 0; c < 3; ++c) terms[3 + c] = jacobian.rotation_b[c] * multiplier;
  const Lane8 torque = sum_lanes(terms);  // on a in lanes 0..2, on b in lanes 3..5
  Lane4 force_a{}, force_b{};
  for (int c = 0; c < 3; ++c) force_a -= jacobian.shift_b[c] * multiplier[c];
  for (int c = 0; c < 3; ++c) force_b -= jacobian.shift_a[c] * multiplier[c];
  on_a = __builtin_shufflevector(widened(force_a), torque, 0, 1, 2, 8, 9, 10, 14, 14);
  on_b = __builtin_shufflevector(widened(force_b), torque, 0, 1, 2, 11, 12, 13, 14, 14);
}

/// J u of one joint, from the motions of its two segments.
inline Lane8 constraint_change(const JointJacobian& jacobian, const Lane8& of_a, const Lane8& of_b) {
  Lane4 stretch{};
  for (int c = 0; c < 3; ++c) stretch += jacobian.shift_a[c] * of_a[c] + jacobian.shift_b[c] * of_b[c];
  Lane8 change = widened(stretch);
  for (int c = 0; c < 3; ++c) change += jacobian.rotation_a[c] * of_a[3 + c] + jacobian.rotation_b[c] * of_b[3 + c];
  return change;
}

/// M^-1 times the impulse on a segment; zero where it is static.
inline Lane8 motion(const Segment& segment, const Lane8& impulse) {
  const double m = segment.inverse_mass, transverse = segment.inverse_inertia_transverse;
  return impulse * Lane8{m, m, m, transverse, transverse, segment.inverse_inertia_axial, 0, 0};
}

}  // namespace rodsweep
