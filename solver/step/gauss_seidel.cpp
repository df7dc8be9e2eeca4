#include "solver/step/gauss_seidel.hpp"

#include <cmath>

#include "solver/linear/block_kernels.hpp"
#include "solver/numbers/rotation.hpp"
#include "solver/rod/joint_kernels.hpp"

namespace rodsweep {
namespace {

void turn(Rod& rod, std::size_t segment, const Vector3& theta) {
  if (!rod.segments[segment].is_static) rod.orientation[segment] = rotated(rod.orientation[segment], theta);
}

/// Returns |C_s| before the correction.
double correct_stretch_shear(Rod& rod, const Joint& joint, double stiffness) {
  const std::size_t a = at(joint.a), b = at(joint.b);
  const Segment &segment_a = rod.segments[a], &segment_b = rod.segments[b];
  const Vector3 rho_a = rod.orientation[a] * joint.arm_a, rho_b = rod.orientation[b] * joint.arm_b;
  const Vector3 gap = rod.position[a] + rho_a - rod.position[b] - rho_b;
  const double turn_a = segment_a.inverse_inertia_transverse, turn_b = segment_b.inverse_inertia_transverse;
  const double yielding = segment_a.inverse_mass + segment_b.inverse_mass + turn_a * joint.arm_a.squaredNorm() +
                          turn_b * joint.arm_b.squaredNorm();
  const Vector3 mu = -stiffness / yielding * gap;
  rod.position[a] += segment_a.inverse_mass * mu;
  rod.position[b] -= segment_b.inverse_mass * mu;
  turn(rod, a, turn_a * rho_a.cross(mu));
  turn(rod, b, -turn_b * rho_b.cross(mu));
  return gap.norm() / joint.length;
}

/// Returns C_b before the correction.
Vector3 correct_bend_twist(Rod& rod, const Joint& joint, double stiffness) {
  const std::size_t a = at(joint.a), b = at(joint.b);
  const auto [e, frame] = turn_from_rest(rod, joint);
  const Vector3 bend = 2 * e.vec();
  const double turn_a = rod.segments[a].inverse_inertia_transverse, turn_b = rod.segments[b].inverse_inertia_transverse;
  const Vector3 torque = stiffness / (turn_a + turn_b) * (frame * Vector3(e.w() * bend));
  turn(rod, a, turn_a * torque);
  turn(rod, b, -turn_b * torque);
  return bend;
}

}  // namespace

std::vector<int> bilateral_order(int joints) {
  std::vector<int> order;
  const int last_odd = joints - 1 - joints % 2;
  for (int even = 0; even < joints; even += 2) {
    order.push_back(even);
    if (last_odd - even > 0) order.push_back(last_odd - even);
  }
  return order;
}

GaussSeidelProjection::GaussSeidelProjection(const Scene& scene) {
  for (const Rod& rod : scene.rods) {
    refuse_static_joints(rod);
    orders_.push_back(bilateral_order(rod.joint_count()));
  }
}

ProjectionReport GaussSeidelProjection::project(Rod& rod, const SolvePosition& at, double dt, double newton_tolerance) {
  const Iteration iteration = iterate(rod, orders_[static_cast<std::size_t>(at.rod)], dt);
  ProjectionReport report{SolveOutcome::converged, iteration.residual};
  if (!std::isfinite(iteration.residual))
    report.outcome = SolveOutcome::not_a_number;
  else if (!iteration.definite)
    report.outcome = SolveOutcome::indefinite;
  else if (iteration.residual < newton_tolerance)
    report.outcome = SolveOutcome::not_run;
  return report;
}

void GaussSeidelProjection::Iteration::meet(const Vector6& met) {
  const double largest = met.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
  residual = larger_or_nan(residual, largest);
}

GaussSeidelProjection::Iteration XpbdProjection::iterate(Rod& rod, const std::vector<int>& order, double dt) const {
  const double inverse_dt2 = 1 / (dt * dt);
  Iteration iteration;
  for (const int joint_index : order) {
    const Joint& joint = rod.joints[at(joint_index)];
    const std::size_t a = at(joint.a), b = at(joint.b);
    JointJacobian jacobian;
    Vector6 residual;
    linearize(rod, joint, jacobian, residual.data());
    auto lambda = rod.lambda.segment<6>(6 * joint_index);
    const Vector6 softness = rod.softness(at(joint_index), inverse_dt2);
    residual = rod.residual(at(joint_index), residual, inverse_dt2);
    iteration.meet(residual);

    Block6 rows;
    add_square<true>(JointSide(jacobian, false), rod.segments[a], softness.data(), rows);
    add_square<false>(JointSide(jacobian, true), rod.segments[b], nullptr, rows);
    for (int r = 0; r < 6; ++r) rows.column[r] = with_lane_6(rows.column[r], broadcast(-residual[r]));
    RowFactor factor;
    iteration.definite &= decompose(rows, factor);
    const Lane8 delta_lambda = solution(factor, rows);

    for (int r = 0; r < 6; ++r) lambda[r] += delta_lambda[r];
    Lane8 on_a, on_b;
    impulses(jacobian, delta_lambda, on_a, on_b);
    displace(rod, a, motion(rod.segments[a], on_a));
    displace(rod, b, motion(rod.segments[b], on_b));
  }
  return iteration;
}

GaussSeidelProjection::Iteration PbdProjection::iterate(Rod& rod, const std::vector<int>& order, double) const {
  Iteration iteration;
  for (const int joint_index : order) {
    const Joint& joint = rod.joints[at(joint_index)];
    Vector6 met;
    met.head<3>() = Vector3(correct_stretch_shear(rod, joint, stiffness_.stretch), 0, 0);
    met.tail<3>() = correct_bend_twist(rod, joint, stiffness_.bending);
    iteration.meet(met);
  }
  return iteration;
}

}  // namespace rodsweep
