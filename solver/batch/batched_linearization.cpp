#include "solver/batch/batched_linearization.hpp"

namespace rodsweep {
void linearize(const BatchedRods& rods, BatchedLinearization& out) {
  Lane residual{}, squared_norm{}, squared_gap{};
  for (std::size_t k = 0; k < rods.joints.size(); ++k) {
    const BatchedJoint& joint = rods.joints[k];
    const BatchedSegment &a = rods.segments[k], &b = rods.segments[k + 1];
    const JointShape<Lane>& shape = joint.shape;
    const JointTurn<Lane> turn = joint_turn(a.orientation, b.orientation, shape);
    out.joints[k] = turn;
    const LaneMatrix half = half_turn(turn);
    const LaneVector gap = stretch(half, a.orientation, shape.inverse_length * (a.position - b.position), shape);
    const LaneVector bent = bend(turn);
    const LaneVector6 constraint = {gap.x, gap.y, gap.z, bent.x, bent.y, bent.z};
    LaneVector6 rhs;
#pragma GCC unroll 6
    for (int row = 0; row < 6; ++row) {
      rhs[row] = -constraint[row] - joint.compliance[row] * joint.lambda[row];
      residual = larger(residual, absolute(rhs[row]));
      squared_norm += rhs[row] * rhs[row];
    }
    const LaneVector turned = to_b(shape, transposed_product(half, {rhs[0], rhs[1], rhs[2]}));
    out.b[k] = {turned.x, turned.y, turned.z, rhs[3], rhs[4], rhs[5]};
    squared_gap = larger(squared_gap, dot(gap, gap));
  }
  out.residual = residual;
  out.squared_norm = squared_norm;
  out.squared_gap = squared_gap;
}

}  // namespace rodsweep
