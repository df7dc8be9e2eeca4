#include "solver/batch/batched_linearization.hpp"

namespace rodsweep {

void linearize(const BatchedRods& rods, BatchedLinearization& out) {
  Lane8 residual{}, squared_norm{}, squared_gap{};
  LaneFrame frame_b = frame(rods.segments.front().orientation);
  out.axes.front() = frame_b.z;
  for (std::size_t k = 0; k < rods.joints.size(); ++k) {
    const BatchedJoint& joint = rods.joints[k];
    const BatchedSegment &a = rods.segments[k], &b = rods.segments[k + 1];
    BatchedJacobian& jacobian = out.joints[k];
    const LaneFrame frame_a = frame_b;
    frame_b = frame(b.orientation);
    out.axes[k + 1] = frame_b.z;

    jacobian.arm_a = frame_a * joint.arm_a;
    jacobian.arm_b = frame_b * joint.arm_b;
    const LaneVector stretch = joint.inverse_length * (a.position - b.position) + jacobian.arm_a - jacobian.arm_b;

    const LaneQuaternion d = in_hemisphere_of(joint.rest, relative(a.orientation, b.orientation));
    jacobian.bend[0] = frame_a * LaneVector{d.w, d.z, -d.y};
    jacobian.bend[1] = frame_a * LaneVector{-d.z, d.w, d.x};
    jacobian.bend[2] = frame_a * LaneVector{d.y, -d.x, d.w};

    const Lane8 bend[3] = {2 * (d.x - joint.rest.x), 2 * (d.y - joint.rest.y), 2 * (d.z - joint.rest.z)};
    const LaneVector6 constraint = {stretch.x, stretch.y, stretch.z, bend[0], bend[1], bend[2]};
#pragma GCC unroll 6
    for (int row = 0; row < 6; ++row) {
      out.b[k][row] = -constraint[row] - joint.compliance[row] * joint.lambda[row];
      residual = larger(residual, absolute(out.b[k][row]));
      squared_norm += out.b[k][row] * out.b[k][row];
    }
    squared_gap = larger(squared_gap, dot(stretch, stretch));
  }
  out.residual = residual;
  out.squared_norm = squared_norm;
  out.squared_gap = squared_gap;
}

}  // namespace rodsweep
