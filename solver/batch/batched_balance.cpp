#include "solver/batch/batched_balance.hpp"

#include <algorithm>

namespace rodsweep {
namespace {

Wrench<Lane> operator-(const Wrench<Lane>& a, const Wrench<Lane>& b) {
  return {a.force - b.force, a.torque - b.torque};
}

Lane squared_size(const Wrench<Lane>& wrench, const Lane& inverse_squared_length) {
  return larger(dot(wrench.force, wrench.force), inverse_squared_length * dot(wrench.torque, wrench.torque));
}

/// (M + K)^-1 times an impulse: u and phi.
Wrench<Lane> motion(const BatchedSegment& segment, const Wrench<Lane>& impulse) {
  return {segment.inverse_mass * impulse.force,
          {segment.turn_mobility * impulse.torque.x, segment.turn_mobility * impulse.torque.y,
           segment.inverse_inertia_axial * impulse.torque.z}};
}

/// Adds J times the motions of its two segments to a joint's b, and returns |b|^2.
Lane add_change(const JointTurn<Lane>& turn, const JointShape<Lane>& shape, const Wrench<Lane>& a,
                const Wrench<Lane>& b, LaneVector6& rhs) {
  const LaneVector of_a = shape.inverse_length * a.force + cross(a.torque, shape.arm_a);
  const LaneVector of_b = shape.inverse_length * b.force + cross(b.torque, shape.arm_b);
  const LaneVector stretch = conjugate(relative_turn(turn, shape)) * of_a - of_b;
  const LaneVector bend = bend_change(turn, shape, a.torque, b.torque);
  const Lane change[6] = {stretch.x, stretch.y, stretch.z, bend.x, bend.y, bend.z};
  Lane squared_norm{};
  for (int row = 0; row < 6; ++row) {
    rhs[row] += change[row];
    squared_norm += rhs[row] * rhs[row];
  }
  return squared_norm;
}

}  // namespace

BatchedBalance::BatchedBalance(const std::vector<Scene>& scenes, const BatchedRods& rods)
    : segments_(rods.segments.size()), least_{}, residual_{}, kept_{} {
  for (int lane = 0; lane < lane_width; ++lane) {
    const Rod& rod = scenes[static_cast<std::size_t>(std::min(lane, rods.rods - 1))].rods.front();
    const MomentumBalance single(rod);
    least_[lane] = single.least;
    for (std::size_t s = 0; s < segments_.size(); ++s) {
      const Segment& segment = rod.segments[s];
      OfSegment& of = segments_[s];
      of.inertia.mass[lane] = segment.mass;
      of.inertia.transverse[lane] = segment.inertia_transverse;
      of.inertia.axial[lane] = segment.inertia_axial;
      of.inverse_squared_length[lane] = single.inverse_squared_length[s];
    }
  }
}

void BatchedBalance::assemble(BatchedRods& rods, BatchedLinearization& at, const LaneMask& kept) {
  kept_ = kept;
  const Lane zero{};
  Lane lacking{}, carried{}, sum{}, squared_norm{}, pull_from_before{};
  Wrench<Lane> from_before{}, moved_before{};
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    BatchedSegment& segment = rods.segments[s];
    OfSegment& of = segments_[s];
    Wrench<Lane> defect =
        impulse_between(rods.free[s], {segment.position, segment.orientation}, of.inertia) - from_before;
    Lane pull = pull_from_before;
    if (s < rods.joints.size()) {
      const BatchedJoint& joint = rods.joints[s];
      const JointTurn<Lane>& turn = at.joints[s];
      const LaneMatrix half = half_turn(turn);
      const LaneVector stretch = {joint.lambda[0], joint.lambda[1], joint.lambda[2]};
      const auto [on_a, on_b] =
          impulses(turn, half, joint.shape, stretch, LaneVector{joint.lambda[3], joint.lambda[4], joint.lambda[5]});
      const Lane length = 1 / joint.shape.inverse_length;
      const Lane scale = joint.shape.inverse_length * joint.shape.inverse_length;
      carried = larger(carried, larger(squared_size(on_a, scale), squared_size(on_b, scale)));
      defect = defect - on_a;
      pull += length * dot(on_a.force, joint.shape.arm_a);
      pull_from_before = length * dot(on_b.force, joint.shape.arm_b);
      from_before = on_b;
    }
    Wrench<Lane> moved{};
    of.defect = Wrench<Lane>{};
    if (!segment.is_static) {
      segment.turn_mobility = 1 / (kept ? stiffened(of.inertia.transverse, pull) : of.inertia.transverse);
      segment.root_turn_mobility = square_root(segment.turn_mobility);
      const LaneVector none{};
      of.defect = {select(kept, defect.force, none), select(kept, defect.torque, none)};
      lacking = larger(lacking, squared_size(of.defect, of.inverse_squared_length));
      sum += of.defect.force.x + of.defect.force.y + of.defect.force.z + of.defect.torque.x + of.defect.torque.y +
             of.defect.torque.z;
      moved = motion(segment, of.defect);
    }
    if (s > 0) squared_norm += add_change(at.joints[s - 1], rods.joints[s - 1].shape, moved_before, moved, at.b[s - 1]);
    moved_before = moved;
  }
  at.squared_norm = squared_norm;
  const Lane greatest = larger(least_, square_root(carried));
  residual_ = rods.joints.empty() ? zero : square_root(lacking) / greatest + 0 * sum;  // NaN where the sum is
}

}  // namespace rodsweep
