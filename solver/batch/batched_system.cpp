#include "solver/batch/batched_system.hpp"

#include <limits>

namespace rodsweep {
namespace {

/// The rows of K D^1/2 of one side of a joint, so that the products of rows are those of K D K^T.
struct Rows {
  LaneVector row[6];
};

/// The last three of [v]x + w I; t and a are D^1/2 across the segment and along it.
inline void bend_rows(const LaneQuaternion& d, const Lane8& w, const Lane8& t, const Lane8& a, Rows& out) {
  const Lane8 tw = t * w, tx = t * d.x, ty = t * d.y, tz = t * d.z;
  out.row[3] = {tw, -tz, a * d.y};
  out.row[4] = {tz, tw, -a * d.x};
  out.row[5] = {-ty, tx, a * w};
}

/// Of side a: -H^T [arm_a]x, then [v]x - w I.
inline Rows rows_a(const BatchedJacobian& jacobian, const LaneMatrix& h, const LaneVector& arm,
                   const BatchedSegment& segment) {
  const Lane8 &t = segment.root_inverse_inertia_transverse, &a = segment.root_inverse_inertia_axial;
  const LaneVector across = t * arm;
  const Lane8 x = a * arm.x, y = a * arm.y;
  Rows out;
  out.row[0] = {across.y * h.x.z - across.z * h.x.y, across.z * h.x.x - across.x * h.x.z, x * h.x.y - y * h.x.x};
  out.row[1] = {across.y * h.y.z - across.z * h.y.y, across.z * h.y.x - across.x * h.y.z, x * h.y.y - y * h.y.x};
  out.row[2] = {across.y * h.z.z - across.z * h.z.y, across.z * h.z.x - across.x * h.z.z, x * h.z.y - y * h.z.x};
  bend_rows(jacobian.turn, -jacobian.turn.w, t, a, out);
  return out;
}

/// Of side b: H [arm_b]x, then [v]x + w I.
inline Rows rows_b(const BatchedJacobian& jacobian, const LaneMatrix& h, const LaneVector& arm,
                   const BatchedSegment& segment) {
  const Lane8 &t = segment.root_inverse_inertia_transverse, &a = segment.root_inverse_inertia_axial;
  const LaneVector across = t * arm;
  const Lane8 x = a * arm.x, y = a * arm.y;
  Rows out;
  out.row[0] = {across.z * h.y.x - across.y * h.z.x, across.x * h.z.x - across.z * h.x.x, y * h.x.x - x * h.y.x};
  out.row[1] = {across.z * h.y.y - across.y * h.z.y, across.x * h.z.y - across.z * h.x.y, y * h.x.y - x * h.y.y};
  out.row[2] = {across.z * h.y.z - across.y * h.z.z, across.x * h.z.z - across.z * h.x.z, y * h.x.z - x * h.y.z};
  bend_rows(jacobian.turn, jacobian.turn.w, t, a, out);
  return out;
}

/// The lower triangle of s += K D K^T.
inline void add_side(const Rows& k, LaneBlock& s) {
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i)
#pragma GCC unroll 6
    for (int j = 0; j <= i; ++j) s[i][j] += dot(k.row[i], k.row[j]);
}

/// B_k: rows of side a of joint k, columns of side b of the joint before; `linear` is 1/(m l l).
inline LaneBlock coupling(const Rows& side, const LaneMatrix& half, const Rows& before, const LaneMatrix& half_before,
                          const Lane8& linear) {
  LaneBlock out;
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i)
#pragma GCC unroll 6
    for (int j = 0; j < 6; ++j) out[i][j] = dot(side.row[i], before.row[j]);
  const LaneVector columns[3] = {-linear * half.x, -linear * half.y, -linear * half.z};
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    const LaneVector shift = half_before * columns[i];
    out[i][0] += shift.x;
    out[i][1] += shift.y;
    out[i][2] += shift.z;
  }
  return out;
}

}  // namespace

LaneMask BatchedSystem::eliminate(const BatchedRods& rods) {
  LaneMask positive = Lane8{} < 1;
  LaneBlock s{};      // what the joint after has taken from A_kk
  LaneVector6 w{};    // and from b_k
  LaneMatrix half{};  // of joint k
  Rows side_b{};
  for (std::size_t k = columns_.size(); k-- > 0;) {
    const BatchedJoint& joint = rods.joints[k];
    const BatchedSegment &a = rods.segments[k], &b = rods.segments[k + 1];
    const BatchedJacobian& jacobian = linearization_.joints[k];
    Column& column = columns_[k];

    if (k + 1 == columns_.size()) {
      half = half_turn(jacobian);
      side_b = rows_b(jacobian, half, joint.arm_b, b);
    }
    const Rows side_a = rows_a(jacobian, half, joint.arm_a, a);
    add_side(side_a, s);
    add_side(side_b, s);
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

    const BatchedJoint& joint_before = rods.joints[k - 1];
    const BatchedJacobian& before = linearization_.joints[k - 1];
    const LaneMatrix half_before = half_turn(before);
    side_b = rows_b(before, half_before, joint_before.arm_b, a);
    LaneBlock block = coupling(side_a, half, side_b, half_before,
                               a.inverse_mass * joint.inverse_length * joint_before.inverse_length);
    half = half_before;
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
      const LaneQuaternion& d = jacobian.turn;
      const LaneVector stretch = {x[0], x[1], x[2]}, bend = {x[3], x[4], x[5]}, v = {d.x, d.y, d.z};
      const LaneMatrix half = half_turn(jacobian);
      const LaneVector on_a = half * stretch, on_b = transposed_product(half, stretch);
      const LaneVector along = d.w * bend, across = cross(v, bend);
      impulse = impulse + joint.inverse_length * on_a;
      turn = turn + cross(joint.arm_a, on_a) - along - across;
      next_impulse = -joint.inverse_length * on_b;
      next_turn = along - across - cross(joint.arm_b, on_b);
    }
    if (!segment.is_static) {
      const LaneVector phi = {segment.inverse_inertia_transverse * turn.x, segment.inverse_inertia_transverse * turn.y,
                              segment.inverse_inertia_axial * turn.z};
      const LaneVector moved = segment.position + segment.orientation * (segment.inverse_mass * impulse);
      segment.position = select(where, moved, segment.position);
      segment.orientation = select(where, turned(segment.orientation, phi), segment.orientation);
    }
    impulse = next_impulse;
    turn = next_turn;
  }
}

}  // namespace rodsweep
