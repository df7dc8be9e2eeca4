#include "solver/rod/joint_forces.hpp"

#include <limits>

#include "solver/rod/linearization.hpp"

namespace rodsweep {

Action joint_action(const Rod& rod, int k) {
  if (!(rod.constraint_dt > 0)) {
    const Vector3 unknown = Vector3::Constant(std::numeric_limits<double>::quiet_NaN());
    return {unknown, unknown};
  }
  const Joint& joint = rod.joints[at(k)];
  const double per_dt2 = 1 / (rod.constraint_dt * rod.constraint_dt);
  const Vector3 stretch = rod.lambda.segment<3>(6 * k), bend = rod.lambda.segment<3>(6 * k + 3);
  const auto [e, frame] = turn_from_rest(rod, joint);
  return {per_dt2 / joint.length * to_world(rod, joint, stretch),
          -per_dt2 * (frame * Vector3(e.w() * bend + e.vec().cross(bend)))};
}

Vector3 point_on_a(const Rod& rod, const Joint& joint) {
  return rod.position[at(joint.a)] + rod.orientation[at(joint.a)] * joint.arm_a;
}

Vector3 point_on_b(const Rod& rod, const Joint& joint) {
  return rod.position[at(joint.b)] + rod.orientation[at(joint.b)] * joint.arm_b;
}

void add_clamp_actions(const Rod& rod, Action& sum) {
  for (int k = 0; k < rod.joint_count(); ++k) {
    const Joint& joint = rod.joints[at(k)];
    const bool a_is_held = rod.segments[at(joint.a)].is_static;
    if (!a_is_held && !rod.segments[at(joint.b)].is_static) continue;
    const auto [force, moment] = joint_action(rod, k);
    if (a_is_held)
      sum.add(point_on_a(rod, joint), -force, -moment);
    else
      sum.add(point_on_b(rod, joint), force, moment);
  }
}

}  // namespace rodsweep
