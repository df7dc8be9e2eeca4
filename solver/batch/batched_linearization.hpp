// Constraints and Jacobians of eight equal chains at once: linearization.hpp's, rod r in lane r.
//
// The sides of a joint are written J_a = (I/l, K_a) and J_b = -(I/l, K_b), the I in the stretch-shear rows, with
//   K u = (u x rho, -G u)  for a turn u;   K^T e_i is row i of K:  rho x e_i, then -G^T e_i.
#pragma once

#include <vector>

#include "solver/batch/batched_rods.hpp"

namespace rodsweep {

struct BatchedJacobian {
  LaneVector arm_a, arm_b;  ///< rho / l, world frame
  LaneVector bend[3];       ///< rows of G
};

struct BatchedLinearization {
  explicit BatchedLinearization(const BatchedRods& rods)
      : joints(rods.joints.size()), b(joints.size()), axes(rods.segments.size()) {}

  std::vector<BatchedJacobian> joints;
  std::vector<LaneVector6> b;    ///< -C - alpha~ lambda
  std::vector<LaneVector> axes;  ///< world direction of every segment's local z

  Lane8 residual;      ///< max |b|
  Lane8 squared_norm;  ///< of b
  Lane8 squared_gap;   ///< of the widest joint, over the joint length
};

/// Evaluates `out` at the rods' positions.
void linearize(const BatchedRods& rods, BatchedLinearization& out);

}  // namespace rodsweep
