#include "solver/step/xpbd_projection.hpp"

#include "solver/linear/axial_compliance.hpp"
#include "solver/linear/block_kernels.hpp"
#include "solver/numbers/rotation.hpp"
#include "solver/rod/joint_kernels.hpp"

namespace rodsweep {
namespace {

/// S += K M^-1 K^T of one side of a joint, rows of S.
void add_side(Lane8 (&s)[6], const Lane8* k, const Segment& segment, const Vector3& axis, double inverse_length) {
  const TurnedColumns turned(k, segment, axis);
  const double linear = segment.inverse_mass * inverse_length * inverse_length;
  for (int r = 0; r < 6; ++r) s[r] += turned.times(k, r);
  for (int r = 0; r < 3; ++r) s[r] += unit_lane[r] * linear;
}

}  // namespace

GaussSeidelProjection::Iteration XpbdProjection::iterate(Rod& rod, const std::vector<int>& order, double dt) const {
  const double inverse_dt2 = 1 / (dt * dt);
  Iteration iteration;
  for (const int joint_index : order) {
    const Joint& joint = rod.joints[static_cast<std::size_t>(joint_index)];
    const std::size_t a = static_cast<std::size_t>(joint.a), b = static_cast<std::size_t>(joint.b);
    const Vector3 axis_a = director(rod.orientation[a]), axis_b = director(rod.orientation[b]);
    JointJacobian jacobian;
    Vector6 residual;
    linearize(rod, joint, jacobian, residual.data());
    auto lambda = rod.lambda.segment<6>(6 * joint_index);
    const Vector6 softness = inverse_dt2 * joint.compliance;
    residual += softness.cwiseProduct(lambda);
    Lane8 s[6];
    for (int r = 0; r < 6; ++r) s[r] = unit_lane[r] * softness[r];
    if (joint.axial_excess != 0) {
      const Matrix3 axial = inverse_dt2 * axial_compliance(joint, axis_a, axis_b);
      residual.head<3>() += axial * lambda.head<3>();
      for (int r = 0; r < 3; ++r) s[r] += Lane8{axial(r, 0), axial(r, 1), axial(r, 2), 0, 0, 0, 0, 0};
    }
    iteration.meet(residual);

    add_side(s, jacobian.rotation_a, rod.segments[a], axis_a, jacobian.inverse_length);
    add_side(s, jacobian.rotation_b, rod.segments[b], axis_b, jacobian.inverse_length);
    for (int r = 0; r < 6; ++r) s[r] = with_lane_6(s[r], broadcast(-residual[r]));
    RowOperations ops;
    iteration.definite &= invert(s, ops);
    Lane8 delta_lambda{};
    for (int r = 0; r < 6; ++r) delta_lambda[r] = s[r][6] * ops.inverse[r][6];

    for (int r = 0; r < 6; ++r) lambda[r] += delta_lambda[r];
    Lane8 on_a, on_b;
    impulses(jacobian, delta_lambda, on_a, on_b);
    move(rod, a, motion(rod.segments[a], axis_a, on_a));
    move(rod, b, motion(rod.segments[b], axis_b, on_b));
  }
  return iteration;
}

}  // namespace rodsweep
