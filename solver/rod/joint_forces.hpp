// The force and the moment that a joint carries, in the world, from the multipliers of the last step. They are those of
// J^T lambda / dt_c^2 (linearization.hpp; dt_c: Rod::constraint_dt), so with the loads and the inertia they balance as
// momentum_balance.hpp says. With e = (w, v) and the frames of linearization.hpp, segment b acts on segment a by
//
//   f = R_m lambda_s / (l dt_c^2),   m = -R_a P_a (w I + [v]x) lambda_b / dt_c^2   about the joint's point,
//
// and a acts on b by -f and -m. Where b follows a along a rod, f along the rod is its tension, and m its bending and
// twisting moment: EI times the curvature, GJ times the twist per length.
#pragma once

#include "solver/rod/rod.hpp"

namespace rodsweep {

/// A force [N] and a moment [N m], in the world.
struct Action {
  Vector3 force_n{0, 0, 0}, moment_nm{0, 0, 0};

  /// Adds a force and a moment that act at a point, with the moment of the force about the origin.
  void add(const Vector3& point_m, const Vector3& force, const Vector3& moment = Vector3::Zero()) {
    force_n += force;
    moment_nm += point_m.cross(force) + moment;
  }
};

/// Of b on a, about the joint's point. NaN before the first step.
Action joint_action(const Rod& rod, int joint);

/// The joint's point as seen from a and from b [m]. They differ by the joint's gap.
Vector3 point_on_a(const Rod& rod, const Joint& joint);
Vector3 point_on_b(const Rod& rod, const Joint& joint);

/// Adds what the held segments exert on the others through joints, about the origin.
void add_clamp_actions(const Rod& rod, Action& sum);

}  // namespace rodsweep
