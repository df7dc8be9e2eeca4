// What one joint contributes to A = J M^-1 J^T and to M^-1 J^T dlambda, in lanes: six rows of C, or one segment's
// (dx, dtheta) in lanes 0..2 and 3..5.
#pragma once

#include "solver/rod/linearization.hpp"

namespace rodsweep {

/// K V, K the three columns dC/dtheta of a side and V = i_t I + (i_a - i_t) t t^T its segment's world inverse inertia.
struct TurnedColumns {
  Lane8 column[3];

  TurnedColumns(const Lane8* k, const Segment& segment, const Vector3& axis) {
    const double transverse = segment.inverse_inertia_transverse;
    const double excess = segment.inverse_inertia_axial - transverse;
    const Lane8 along = excess * (k[0] * axis.x() + k[1] * axis.y() + k[2] * axis.z());
    column[0] = k[0] * transverse + along * axis.x();
    column[1] = k[1] * transverse + along * axis.y();
    column[2] = k[2] * transverse + along * axis.z();
  }

  /// Column c of K V K'^T.
  Lane8 times(const Lane8* other, int c) const {
    return column[0] * other[0][c] + column[1] * other[1][c] + column[2] * other[2][c];
  }
};

/// J^T dlambda of one joint: the impulses on its two segments.
inline void impulses(const JointJacobian& jacobian, const Lane8& multiplier, Lane8& on_a, Lane8& on_b) {
  Lane8 terms[6];
  for (int c = 0; c < 3; ++c) terms[c] = jacobian.rotation_a[c] * multiplier;
  for (int c = 0; c < 3; ++c) terms[3 + c] = jacobian.rotation_b[c] * multiplier;
  const Lane8 torque = sum_lanes(terms);  // on a in lanes 0..2, on b in lanes 3..5
  const Lane8 force = multiplier * jacobian.inverse_length;
  on_a = __builtin_shufflevector(force, torque, 0, 1, 2, 8, 9, 10, 14, 14);
  on_b = __builtin_shufflevector(-force, torque, 0, 1, 2, 11, 12, 13, 14, 14);
}

/// J u of one joint, from the motions of its two segments.
inline Lane8 constraint_change(const JointJacobian& jacobian, const Lane8& of_a, const Lane8& of_b) {
  Lane8 change = (of_a - of_b) * (jacobian.inverse_length * Lane8{1, 1, 1, 0, 0, 0, 0, 0});
  for (int c = 0; c < 3; ++c) change += jacobian.rotation_a[c] * of_a[3 + c] + jacobian.rotation_b[c] * of_b[3 + c];
  return change;
}

/// M^-1 times the impulse on a segment; zero where it is static.
inline Lane8 motion(const Segment& segment, const Vector3& axis, const Lane8& impulse) {
  const double m = segment.inverse_mass, transverse = segment.inverse_inertia_transverse;
  const double along = axis.x() * impulse[3] + axis.y() * impulse[4] + axis.z() * impulse[5];
  return impulse * Lane8{m, m, m, transverse, transverse, transverse, 0, 0} +
         (segment.inverse_inertia_axial - transverse) * along * Lane8{0, 0, 0, axis.x(), axis.y(), axis.z(), 0, 0};
}

}  // namespace rodsweep
