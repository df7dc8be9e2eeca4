#include "solver/step/pbd_projection.hpp"

#include "solver/numbers/rotation.hpp"
#include "solver/rod/linearization.hpp"

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
