// Constraints of several equal chains at once: linearization.hpp's, rod r in lane r.
//
// Of a joint's Jacobian only what H is made of is kept. Residual, norm and gap are those of b in the joints' frames;
// the stretch-shear rows of b are left in the frames of the joints' second segments, R_b^T R_m = H^T, for
// batched_system.hpp.
#pragma once

#include <vector>

#include "solver/batch/batched_rods.hpp"

namespace rodsweep {

struct BatchedJacobian {
  LaneQuaternion turn;  ///< d
  Lane scale;           ///< 1 / (1 + w)
};

/// H = R(d^(1/2)) = w I + [v]x + v v^T / (1 + w).
inline LaneMatrix half_turn(const BatchedJacobian& jacobian) {
  const LaneQuaternion& d = jacobian.turn;
  const LaneVector v = {d.x, d.y, d.z}, scaled = jacobian.scale * v;
  const Lane xy = v.x * scaled.y, xz = v.x * scaled.z, yz = v.y * scaled.z;
  return {{d.w + v.x * scaled.x, xy + v.z, xz - v.y},
          {xy - v.z, d.w + v.y * scaled.y, yz + v.x},
          {xz + v.y, yz - v.x, d.w + v.z * scaled.z}};
}

struct BatchedLinearization {
  explicit BatchedLinearization(const BatchedRods& rods) : joints(rods.joints.size()), b(joints.size()) {}

  std::vector<BatchedJacobian> joints;
  std::vector<LaneVector6> b;  ///< -C - alpha~ lambda, its first three rows turned by H^T

  Lane residual;      ///< max |b|
  Lane squared_norm;  ///< of b
  Lane squared_gap;   ///< of the widest joint, over the joint length
};

/// Evaluates `out` at the rods' positions.
void linearize(const BatchedRods& rods, BatchedLinearization& out);

}  // namespace rodsweep
