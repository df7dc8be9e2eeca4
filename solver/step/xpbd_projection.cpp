#include "solver/step/xpbd_projection.hpp"

#include "solver/linear/block_kernels.hpp"
#include "solver/rod/joint_kernels.hpp"

namespace rodsweep {

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
    const Vector6 softness = inverse_dt2 * joint.compliance;
    residual += softness.cwiseProduct(lambda);
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

}  // namespace rodsweep
