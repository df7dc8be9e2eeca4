#include "solver/step/gauss_seidel.hpp"

#include <cmath>

namespace rodsweep {

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
  if (!(largest <= residual)) residual = std::isnan(residual) ? residual : largest;
}

}  // namespace rodsweep
