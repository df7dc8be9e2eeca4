#include "solver/batch/batched_system.hpp"

#include <limits>

namespace rodsweep {
namespace {

/// One side of a joint.
struct Side {
  const LaneVector& arm;
  const LaneVector (&bend)[3];
};

/// K u.
inline LaneVector6 rates(const Side& side, const LaneVector& u) {
  const LaneVector stretch = cross(u, side.arm);
  return {stretch.x, stretch.y, stretch.z, -dot(side.bend[0], u), -dot(side.bend[1], u), -dot(side.bend[2], u)};
}

/// V K^T e_i, the rows of K V, with V = transverse I + excess axis axis^T.
struct WeightedRows {
  LaneVector row[6];

  WeightedRows(const Side& side, const BatchedSegment& segment, const LaneVector& axis) {
    const LaneVector excess = segment.inverse_inertia_excess * axis;
    const LaneVector arm = segment.inverse_inertia_transverse * side.arm;
    const LaneVector along = cross(axis, side.arm);  // axis . (rho x e_i)
    const Lane8 zero{};
    row[0] = LaneVector{zero, arm.z, -arm.y} + along.x * excess;
    row[1] = LaneVector{-arm.z, zero, arm.x} + along.y * excess;
    row[2] = LaneVector{arm.y, -arm.x, zero} + along.z * excess;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      const LaneVector transverse = -segment.inverse_inertia_transverse * side.bend[i];
      row[3 + i] = transverse - dot(axis, side.bend[i]) * excess;
    }
  }
};

/// The lower triangle of s += K V K^T.
inline void add_side(const Side& side, const WeightedRows& weighted, LaneBlock& s) {
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i) {
    const LaneVector6 row = rates(side, weighted.row[i]);
#pragma GCC unroll 6
    for (int j = 0; j <= i; ++j) s[i][j] += row[j];
  }
}

/// B_k: rows of side a of joint k, `weighted`, columns of side b of the joint before; `linear` is 1/(m l l).
inline LaneBlock coupling(const WeightedRows& weighted, const Side& before, const Lane8& linear) {
  LaneBlock out;
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i) {
    const LaneVector6 row = rates(before, weighted.row[i]);
#pragma GCC unroll 6
    for (int j = 0; j < 6; ++j) out[i][j] = i == j && i < 3 ? -row[j] - linear : -row[j];
  }
  return out;
}

}  // namespace

LaneMask BatchedSystem::eliminate(const BatchedRods& rods) {
  LaneMask positive = Lane8{} < 1;
  LaneBlock s{};    // what the joint after has taken from A_kk
  LaneVector6 w{};  // and from b_k
  for (std::size_t k = columns_.size(); k-- > 0;) {
    const BatchedJoint& joint = rods.joints[k];
    const BatchedSegment &a = rods.segments[k], &b = rods.segments[k + 1];
    const BatchedJacobian& jacobian = linearization_.joints[k];
    Column& column = columns_[k];

    const Side side_a{jacobian.arm_a, jacobian.bend}, side_b{jacobian.arm_b, jacobian.bend};
    const WeightedRows weighted_a(side_a, a, linearization_.axes[k]);
    add_side(side_a, weighted_a, s);
    add_side(side_b, WeightedRows(side_b, b, linearization_.axes[k + 1]), s);
    const Lane8 linear = (a.inverse_mass + b.inverse_mass) * joint.inverse_length * joint.inverse_length;
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
      s[i][i] += i < 3 ? joint.compliance[i] + linear : joint.compliance[i];
      w[i] += linearization_.b[k][i];
    }

    positive &= factorise(s, column.factor);
    forward(column.factor, w);
    column.solution = divided(column.factor, w);
    if (k == 0) break;

    const BatchedJacobian& before = linearization_.joints[k - 1];
    LaneBlock block = coupling(weighted_a, {before.arm_b, before.bend},
                               a.inverse_mass * joint.inverse_length * rods.joints[k - 1].inverse_length);
    forward(column.factor, block);
    column.u = divided(column.factor, block);
    s = minus_gram(block, column.u);
    w = minus_product(block, column.solution);
  }
  return positive;
}

LaneMask BatchedSystem::below(double tolerance) const {
  const LaneMask finite = linearization_.squared_norm <= std::numeric_limits<double>::max();
  return finite & (linearization_.residual < tolerance);
}

BatchedSystem::Outcome BatchedSystem::solve(const BatchedRods& rods) {
  const LaneMask positive = eliminate(rods);
  Lane8 sum{};
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    Column& column = columns_[k];
    LaneVector6 x = column.solution;
    if (k > 0) subtract_product(x, column.u, columns_[k - 1].solution);
    backward(column.factor, x);
    column.solution = x;
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) sum += x[i];
  }
  return {positive, absolute(sum) <= std::numeric_limits<double>::max()};
}

void BatchedSystem::write_solution(int lane, double* solution) const {
  for (const Column& column : columns_)
    for (int row = 0; row < 6; ++row) *solution++ = column.solution[row][lane];
}

void BatchedSystem::apply(BatchedRods& rods, const LaneMask& where) const {
  LaneVector impulse{}, turn{};  // on this segment, from the joint before
  for (std::size_t s = 0; s < rods.segments.size(); ++s) {
    BatchedSegment& segment = rods.segments[s];
    LaneVector next_impulse{}, next_turn{};
    if (s < columns_.size()) {
      const BatchedJacobian& jacobian = linearization_.joints[s];
      const LaneVector6& x = columns_[s].solution;
      BatchedJoint& joint = rods.joints[s];
#pragma GCC unroll 6
      for (int row = 0; row < 6; ++row) joint.lambda[row] = where ? joint.lambda[row] + x[row] : joint.lambda[row];
      const LaneVector stretch = {x[0], x[1], x[2]};
      const LaneVector force = joint.inverse_length * stretch;
      const LaneVector bend = x[3] * jacobian.bend[0] + x[4] * jacobian.bend[1] + x[5] * jacobian.bend[2];
      impulse = impulse + force;
      turn = turn + cross(jacobian.arm_a, stretch) - bend;
      next_impulse = -force;
      next_turn = bend - cross(jacobian.arm_b, stretch);
    }
    if (!segment.is_static) {
      const LaneVector& axis = linearization_.axes[s];
      const LaneVector theta =
          segment.inverse_inertia_transverse * turn + segment.inverse_inertia_excess * dot(axis, turn) * axis;
      segment.position = select(where, segment.position + segment.inverse_mass * impulse, segment.position);
      segment.orientation = select(where, rotated(segment.orientation, theta), segment.orientation);
    }
    impulse = next_impulse;
    turn = next_turn;
  }
}

}  // namespace rodsweep
