#include "solver/batch/batched_linearization.hpp"

namespace rodsweep {
void linearize(const BatchedRods& rods, BatchedLinearization& out) {
  Lane residual{}, squared_norm{}, squared_gap{};
  for (std::size_t k = 0; k < rods.joints.size(); ++k) {
    const BatchedJoint& joint = rods.joints[k];
    const BatchedSegment &a = rods.segments[k], &b = rods.segments[k + 1];
    const LaneQuaternion d = in_hemisphere_of(joint.rest, relative(a.orientation, b.orientation));
    out.joints[k] = {d, 1 / (1 + d.w)};
    const LaneMatrix half = half_turn(out.joints[k]);

    const LaneVector apart = conjugate(a.orientation) * (joint.inverse_length * (a.position - b.position));
    const LaneVector stretch = transposed_product(half, apart + joint.arm_a) - half * joint.arm_b;
    const LaneVector6 constraint = {
        stretch.x, stretch.y, stretch.z, 2 * (d.x - joint.rest.x), 2 * (d.y - joint.rest.y), 2 * (d.z - joint.rest.z)};
    LaneVector6 rhs;
#pragma GCC unroll 6
    for (int row = 0; row < 6; ++row) {
      rhs[row] = -constraint[row] - joint.compliance[row] * joint.lambda[row];
      residual = larger(residual, absolute(rhs[row]));
      squared_norm += rhs[row] * rhs[row];
    }
    const LaneVector turned = transposed_product(half, {rhs[0], rhs[1], rhs[2]});
    out.b[k] = {turned.x, turned.y, turned.z, rhs[3], rhs[4], rhs[5]};
    squared_gap = larger(squared_gap, dot(stretch, stretch));
  }
  out.residual = residual;
  out.squared_norm = squared_norm;
  out.squared_gap = squared_gap;
}

}  // namespace rodsweep
