// Constraints of several equal chains at once, as in linearization.hpp, rod r in lane r.
//
// A joint's Jacobian is stored as its JointTurn only. Residual, norm and gap are those of b in the joints' frames. The
// stretch-shear rows of b are in the frames of the joints' second segments, R_b^T R_m = H^T, for batched_system.hpp.
#pragma once

#include <vector>

#include "solver/batch/batched_rods.hpp"

namespace rodsweep {

struct BatchedLinearization {
  explicit BatchedLinearization(const BatchedRods& rods) : joints(rods.joints.size()), b(joints.size()) {}

  std::vector<JointTurn<Lane>> joints;
  std::vector<LaneVector6> b;  ///< -C - alpha~ lambda, its first three rows turned by H^T

  Lane residual;      ///< max |b|
  Lane squared_norm;  ///< of b
  Lane squared_gap;   ///< of the widest gap, over the joint length
};

/// Evaluates `out` at the rods' positions.
void linearize(const BatchedRods& rods, BatchedLinearization& out);

}  // namespace rodsweep
