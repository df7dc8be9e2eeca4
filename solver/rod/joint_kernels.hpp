// The contributions of one joint to A = J M^-1 J^T and to M^-1 J^T dlambda, in lanes: six rows of C, or one segment's
// (u, phi) in lanes 0..2 and 3..5. In the segments' own frames M is diagonal.
#pragma once

#include "solver/rod/linearization.hpp"

namespace rodsweep {

/// Three lanes, then zeros.
inline Lane8 widened(const Lane4& v) { return __builtin_shufflevector(v, Lane4{}, 0, 1, 2, 4, 4, 4, 4, 4); }

/// One side of a joint.
struct JointSide {
  const Lane8* rotation;  ///< columns of dC/dphi
  const Lane4* shift;     ///< columns of dC_s/du
  double inverse_length;

  JointSide(const JointJacobian& jacobian, bool is_b)
      : rotation(is_b ? jacobian.rotation_b : jacobian.rotation_a),
        shift(is_b ? jacobian.shift_b : jacobian.shift_a),
        inverse_length(jacobian.inverse_length) {}
};

/// block = or += J M^-1 J'^T of two joints' sides on one segment.
template <bool first>
inline void add_product(const JointSide& side, const JointSide& other, const Segment& segment, Block6& block) {
  const double weight[3] = {segment.turn_mobility, segment.turn_mobility, segment.inverse_inertia_axial};
#pragma GCC unroll 4
  for (int p = 0; p < slices; ++p) {
    Lane rotation[3], shift[3];
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) rotation[j] = weight[j] * slice_of(side.rotation[j], p);
    const bool shifts = p * lane_width < 3;
    if (shifts)
#pragma GCC unroll 3
      for (int j = 0; j < 3; ++j) shift[j] = segment.inverse_mass * slice_of(side.shift[j], p);
#pragma GCC unroll 6
    for (int c = 0; c < 6; ++c) {
      Lane column = first ? rotation[0] * entry(other.rotation[0], c)
                          : slice_of(block.column[c], p) + rotation[0] * entry(other.rotation[0], c);
      column += rotation[1] * entry(other.rotation[1], c);
      column += rotation[2] * entry(other.rotation[2], c);
      if (shifts && c < 3)
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j) column += shift[j] * entry(other.shift[j], c);
      set_slice(block.column[c], p, column);
    }
  }
}

/// block = J M^-1 J^T of one side plus `diagonal`, or block += J M^-1 J^T.
template <bool first>
inline void add_square(const JointSide& side, const Segment& segment, const double* diagonal, Block6& block) {
  const double weight[3] = {segment.turn_mobility, segment.turn_mobility, segment.inverse_inertia_axial};
  const double shift = segment.inverse_mass * side.inverse_length * side.inverse_length;  // H is orthogonal
#pragma GCC unroll 4
  for (int p = 0; p < slices; ++p) {
    Lane rotation[3];
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) rotation[j] = weight[j] * slice_of(side.rotation[j], p);
#pragma GCC unroll 6
    for (int c = 0; c < 6; ++c) {
      Lane column = rotation[0] * entry(side.rotation[0], c);
      column += rotation[1] * entry(side.rotation[1], c);
      column += rotation[2] * entry(side.rotation[2], c);
      if (!first) column += slice_of(block.column[c], p);
      if (c / lane_width == p) column += ((first ? diagonal[c] : 0) + (c < 3 ? shift : 0)) * slice_of(unit_lane[c], p);
      set_slice(block.column[c], p, column);
    }
  }
}

/// J^T dlambda of one joint: the impulses on its two segments.
inline void impulses(const JointJacobian& jacobian, const Lane8& multiplier, Lane8& on_a, Lane8& on_b) {
  if (jacobian.straight) {
    Lane8 terms[6];
    for (int c = 0; c < 3; ++c) terms[c] = jacobian.rotation_a[c] * multiplier;
    for (int c = 0; c < 3; ++c) terms[3 + c] = jacobian.rotation_b[c] * multiplier;
    const Lane8 torque = sum_lanes(terms);  // on a in lanes 0..2, on b in lanes 3..5
    Lane4 force_a{}, force_b{};
    for (int c = 0; c < 3; ++c) force_a -= jacobian.shift_b[c] * multiplier[c];
    for (int c = 0; c < 3; ++c) force_b -= jacobian.shift_a[c] * multiplier[c];
    on_a = __builtin_shufflevector(widened(force_a), torque, 0, 1, 2, 8, 9, 10, 14, 14);
    on_b = __builtin_shufflevector(widened(force_b), torque, 0, 1, 2, 11, 12, 13, 14, 14);
    return;
  }
  Lane8 of_a[6], of_b[6];
  for (int c = 0; c < 3; ++c) {
    of_a[c] = widened(jacobian.shift_a[c]) * multiplier;
    of_b[c] = widened(jacobian.shift_b[c]) * multiplier;
    of_a[3 + c] = jacobian.rotation_a[c] * multiplier;
    of_b[3 + c] = jacobian.rotation_b[c] * multiplier;
  }
  on_a = sum_lanes(of_a);
  on_b = sum_lanes(of_b);
}

/// J u of one joint, from the motions of its two segments.
inline Lane8 constraint_change(const JointJacobian& jacobian, const Lane8& of_a, const Lane8& of_b) {
  Lane4 stretch{};
  for (int c = 0; c < 3; ++c) stretch += jacobian.shift_a[c] * of_a[c] + jacobian.shift_b[c] * of_b[c];
  Lane8 change = widened(stretch);
  for (int c = 0; c < 3; ++c) change += jacobian.rotation_a[c] * of_a[3 + c] + jacobian.rotation_b[c] * of_b[3 + c];
  return change;
}

/// The rotation of a joint's frame R_m, in itself and to first order: the mean of its segments' rotations. H^T and -H
/// are l dC_s/du.
inline Lane4 frame_turn(const JointJacobian& jacobian, const Lane8& of_a, const Lane8& of_b) {
  Lane4 twice{};
  for (int c = 0; c < 3; ++c) twice += jacobian.shift_a[c] * of_a[3 + c] - jacobian.shift_b[c] * of_b[3 + c];
  return twice * (0.5 / jacobian.inverse_length);
}

/// M^-1 (or (M + K)^-1) times the impulse on a segment; zero if it is static.
inline Lane8 motion(const Segment& segment, const Lane8& impulse) {
  const double m = segment.inverse_mass, transverse = segment.turn_mobility;
  return impulse * Lane8{m, m, m, transverse, transverse, segment.inverse_inertia_axial, 0, 0};
}

}  // namespace rodsweep
