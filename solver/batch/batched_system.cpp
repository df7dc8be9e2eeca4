#include "solver/batch/batched_system.hpp"

#include <limits>

namespace rodsweep {
namespace {

/// One side of a joint by columns of K D^1/2, so that K D K^T is the sum of their squares.
struct Side {
  LaneVector6 column[3];
};

struct Sides {
  Side a, b;
  LaneVector6 shift[6]{};  ///< columns of -S/(m l), m the mass of a; zero beyond the stretch-shear rows and columns
};

inline void put(const LaneVector& v, Lane* to) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}

/// The last three rows, ([v]x + w I) P^T; t and a are D^1/2 across the segment and along it. Out of line, because
/// straight joints are the rule.
[[gnu::noinline]] void put_kinked_bend(const LaneQuaternion& e, const Lane& w, const LaneMatrix& p, const Lane& t,
                                       const Lane& a, Side& out) {
  const LaneVector v = {e.x, e.y, e.z};
  const auto column = [&](const Lane& x, const Lane& y, const Lane& z) {
    const LaneVector row = {x, y, z};
    return w * row + cross(v, row);
  };
  put(t * column(p.x.x, p.y.x, p.z.x), out.column[0].row + 3);
  put(t * column(p.x.y, p.y.y, p.z.y), out.column[1].row + 3);
  put(a * column(p.x.z, p.y.z, p.z.z), out.column[2].row + 3);
}

[[gnu::always_inline]] inline void put_bend(const LaneQuaternion& e, const Lane& w, const LaneMatrix* axes,
                                            const Lane& t, const Lane& a, Side& out) {
  if (axes) return put_kinked_bend(e, w, *axes, t, a, out);
  const Lane tw = t * w, tz = t * e.z;
  put({tw, tz, -t * e.y}, out.column[0].row + 3);
  put({-tz, tw, t * e.x}, out.column[1].row + 3);
  put({a * e.y, -a * e.x, a * w}, out.column[2].row + 3);
}

/// -S [arm_a]x, then ([v]x - w I) P_a^T; and the shift.
[[gnu::always_inline]] inline void put_side_a(const JointTurn<Lane>& turn, const BatchedJoint& joint,
                                              const BatchedSegment& segment, Sides& out) {
  const Lane &t = segment.root_turn_mobility, &a = segment.root_inverse_inertia_axial;
  const LaneMatrix s = rotation_matrix(conjugate(relative_turn(turn, joint.shape)));
  const LaneVector arm = t * joint.shape.arm_a;
  put(arm.y * s.z - arm.z * s.y, out.a.column[0].row);
  put(arm.z * s.x - arm.x * s.z, out.a.column[1].row);
  put((a * joint.shape.arm_a.x) * s.y - (a * joint.shape.arm_a.y) * s.x, out.a.column[2].row);
  put_bend(turn.e, -turn.e.w, joint.shape.kink ? &joint.shape.kink->axes_a : nullptr, t, a, out.a);
  const Lane scale = -segment.inverse_mass * joint.shape.inverse_length;
  put(scale * s.x, out.shift[0].row);
  put(scale * s.y, out.shift[1].row);
  put(scale * s.z, out.shift[2].row);
}

/// [arm_b]x, then ([v]x + w I) P_b^T.
[[gnu::always_inline]] inline void put_side_b(const JointTurn<Lane>& turn, const BatchedJoint& joint,
                                              const BatchedSegment& segment, Sides& out) {
  const Lane &t = segment.root_turn_mobility, &a = segment.root_inverse_inertia_axial, zero{};
  const LaneVector arm = t * joint.shape.arm_b;
  put({zero, arm.z, -arm.y}, out.b.column[0].row);
  put({-arm.z, zero, arm.x}, out.b.column[1].row);
  put({a * joint.shape.arm_b.y, -a * joint.shape.arm_b.x, zero}, out.b.column[2].row);
  put_bend(turn.e, turn.e.w, joint.shape.kink ? &joint.shape.kink->axes_b : nullptr, t, a, out.b);
}

/// Writes P_b H^T diag(c) H P_b^T to the lower triangle's stretch-shear rows.
inline void put_turned_compliance(const JointTurn<Lane>& turn, const JointShape<Lane>& shape, const LaneVector6& c,
                                  LaneBlock& out) {
  LaneMatrix h = half_turn(turn);
  if (shape.kink) {
    const LaneMatrix& p = shape.kink->axes_b;
    h = {h * LaneVector{p.x.x, p.y.x, p.z.x}, h * LaneVector{p.x.y, p.y.y, p.z.y}, h * LaneVector{p.x.z, p.y.z, p.z.z}};
  }
  const LaneVector across = {c[0] * h.x.x, c[1] * h.x.y, c[2] * h.x.z}, up = {c[0] * h.y.x, c[1] * h.y.y, c[2] * h.y.z},
                   along = {c[0] * h.z.x, c[1] * h.z.y, c[2] * h.z.z};
  out[0][0] = dot(across, h.x);
  out[1][0] = dot(up, h.x);
  out[1][1] = dot(up, h.y);
  out[2][0] = dot(along, h.x);
  out[2][1] = dot(along, h.y);
  out[2][2] = dot(along, h.z);
}

/// A_kk before the next joint is eliminated, and the sides of joint k.
[[gnu::always_inline]] inline LaneBlock evaluate(const BatchedRods& rods, const JointTurn<Lane>& turn, std::size_t k,
                                                 Sides& sides) {
  const BatchedJoint& joint = rods.joints[k];
  const BatchedSegment &a = rods.segments[k], &b = rods.segments[k + 1];
  put_side_a(turn, joint, a, sides);
  put_side_b(turn, joint, b, sides);
  LaneBlock out{};
#pragma GCC unroll 6
  for (int i = 0; i < 6; ++i) out[i][i] = joint.compliance[i];
  if (!rods.stretches_evenly) put_turned_compliance(turn, joint.shape, joint.compliance, out);
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i)
    out[i][i] += (a.inverse_mass + b.inverse_mass) * joint.shape.inverse_length * joint.shape.inverse_length;
#pragma GCC unroll 1
  for (const LaneVector6& column : sides.a.column) add_square(out, column);
#pragma GCC unroll 1
  for (const LaneVector6& column : sides.b.column) add_square(out, column);
  return out;
}

/// Column c of B_k, from side a of joint k and side b of the joint before, of length 1 / `inverse_length`.
inline LaneVector6 coupling(const Sides& sides, const Side& before, const Lane& inverse_length, int c) {
  LaneVector6 out = sides.shift[c];
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) out[i] *= inverse_length;
#pragma GCC unroll 3
  for (int j = 0; j < 3; ++j)
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) out[i] += sides.a.column[j][i] * before.column[j][c];
  return out;
}

/// Keeps the stretch-shear force constant in the world while the joint's segments rotate.
inline void hold_force(const JointTurn<Lane>& turn, const LaneVector& phi_a, const LaneVector& phi_b,
                       const LaneMask& where, BatchedJoint& joint) {
  const LaneMatrix half = half_turn(turn);
  const LaneVector delta =
      all_lanes(0.5) * (transposed_product(half, from_a(joint.shape, phi_a)) + half * from_b(joint.shape, phi_b));
  LaneVector6& lambda = joint.lambda;
  const LaneVector force = {lambda[0], lambda[1], lambda[2]};
  const LaneVector held = select(where, turned_back(force, delta), force);
  lambda[0] = held.x;
  lambda[1] = held.y;
  lambda[2] = held.z;
}

}  // namespace

void BatchedSystem::linearize(BatchedRods& rods, const LaneMask& kept) {
  rodsweep::linearize(rods, linearization_);
  if (balance_) balance_->assemble(rods, linearization_, kept);
}

LaneMask BatchedSystem::eliminate(const BatchedRods& rods) {
  LaneMask positive = Lane{} < 1;
  if (columns_.empty()) return positive;
  std::size_t k = columns_.size() - 1;
  Sides sides[2];  // of joints k and k - 1, at their numbers modulo 2
  LaneBlock s = evaluate(rods, linearization_.joints[k], k, sides[k % 2]);
  LaneVector6 w{};  // the next joint's term in b_k
  for (;; --k) {
    Column& column = columns_[k];
    positive &= factorise(s, column.factor);
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) w[i] += linearization_.b[k][i];
    forward(column.factor, w);
    column.solution = divided(column.factor, w);
    if (k == 0) return positive;

    Sides& before = sides[(k - 1) % 2];
    s = evaluate(rods, linearization_.joints[k - 1], k - 1, before);
    LaneVector6 eliminated[6];  // W, by columns
#pragma GCC unroll 1
    for (int c = 0; c < 6; ++c) {
      LaneVector6 v = coupling(sides[k % 2], before.b, rods.joints[k - 1].shape.inverse_length, c);
      forward(column.factor, v);
      eliminated[c] = v;
      column.u[c] = divided(column.factor, v);
    }
    w = LaneVector6{};
    subtract_products(s, w, eliminated, column.u, column.solution);
  }
}

LaneMask BatchedSystem::below(double tolerance, double momentum_tolerance) const {
  const LaneMask finite = linearization_.squared_norm <= std::numeric_limits<double>::max();
  const LaneMask closed = finite & (linearization_.residual < tolerance);
  return balance_ ? closed & (balance_->residual() < momentum_tolerance) : closed;
}

BatchedSystem::Outcome BatchedSystem::solve(const BatchedRods& rods) {
  const LaneMask positive = eliminate(rods);
  Lane sum{};
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    Column& column = columns_[k];
    LaneVector6 y = column.solution;
    if (k > 0) subtract_product(y, column.u, columns_[k - 1].solution);
    backward(column.factor, y);
    column.solution = y;
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) sum += y[i];
  }
  return {positive, absolute(sum) <= std::numeric_limits<double>::max()};
}

void BatchedSystem::write_solution(const BatchedRods& rods, int lane, double* solution) const {
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const LaneVector6& y = columns_[k].solution;
    const LaneVector stretch =
        half_turn(linearization_.joints[k]) * from_b(rods.joints[k].shape, LaneVector{y[0], y[1], y[2]});
    for (const Lane& row : {stretch.x, stretch.y, stretch.z, y[3], y[4], y[5]}) *solution++ = row[lane];
  }
}

void BatchedSystem::apply(BatchedRods& rods, const LaneMask& where) const {
  Wrench<Lane> on_this{};  // from the joint before
  LaneVector phi_before{};
  for (std::size_t s = 0; s < rods.segments.size(); ++s) {
    BatchedSegment& segment = rods.segments[s];
    Wrench<Lane> on_next{};
    if (s < columns_.size()) {
      const JointTurn<Lane>& turn = linearization_.joints[s];
      const LaneVector6& y = columns_[s].solution;
      BatchedJoint& joint = rods.joints[s];
      const LaneMatrix half = half_turn(turn);
      const LaneVector on_b = {y[0], y[1], y[2]}, bend = {y[3], y[4], y[5]};
      const LaneVector stretch = half * from_b(joint.shape, on_b);
      const LaneVector6 x = {stretch.x, stretch.y, stretch.z, bend.x, bend.y, bend.z};
#pragma GCC unroll 6
      for (int row = 0; row < 6; ++row) joint.lambda[row] = where ? joint.lambda[row] + x[row] : joint.lambda[row];
      const auto [next_of_a, next_of_b] = impulses(turn, joint.shape, to_a(joint.shape, half * stretch), on_b, bend);
      on_this = {on_this.force + next_of_a.force, on_this.torque + next_of_a.torque};
      on_next = next_of_b;
    }
    LaneVector phi{};
    if (!segment.is_static) {
      if (balance_) {
        const Wrench<Lane>& g = balance_->defect(s);
        on_this = {on_this.force - g.force, on_this.torque - g.torque};
      }
      phi = {segment.turn_mobility * on_this.torque.x, segment.turn_mobility * on_this.torque.y,
             segment.inverse_inertia_axial * on_this.torque.z};
      const LaneVector moved = segment.position + segment.orientation * (segment.inverse_mass * on_this.force);
      segment.position = select(where, moved, segment.position);
      segment.orientation = select(where, turned(segment.orientation, phi), segment.orientation);
    }
    if (balance_ && s > 0)
      hold_force(linearization_.joints[s - 1], phi_before, phi, where & balance_->kept(), rods.joints[s - 1]);
    phi_before = phi;
    on_this = on_next;
  }
}

}  // namespace rodsweep
