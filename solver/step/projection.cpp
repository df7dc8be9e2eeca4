#include "solver/step/projection.hpp"

#include "solver/step/stopwatch.hpp"

namespace rodsweep {

std::vector<VectorX> unknowns_of(const Scene& scene) {
  std::vector<VectorX> out;
  for (const Rod& rod : scene.rods) out.push_back(VectorX::Zero(6 * rod.joint_count()));
  return out;
}

LinearProjection::LinearProjection(const Scene& scene, LinearSolve& solve, std::optional<double> momentum_tolerance)
    : systems_(scene.rods.begin(), scene.rods.end()),
      delta_lambda_(unknowns_of(scene)),
      solve_(solve),
      momentum_tolerance_(momentum_tolerance) {}

ProjectionReport LinearProjection::project(Rod& rod, const SolvePosition& at, double dt, double newton_tolerance) {
  LinearSystem& system = systems_[static_cast<std::size_t>(at.rod)];
  VectorX& delta_lambda = delta_lambda_[static_cast<std::size_t>(at.rod)];
  const Stopwatch watch;
  if (keeps_balance_)
    system.assemble_balanced(rod, dt);
  else
    system.assemble(rod, dt);
  const double assemble_s = watch.seconds();

  ProjectionReport report{SolveOutcome::not_run, system.newton_residual(), system.momentum_residual()};
  const bool balanced = !keeps_balance_ || report.momentum_residual < *momentum_tolerance_;
  if (report.newton_residual < newton_tolerance && balanced) return report;
  report.outcome = solve_.solve(system, at, assemble_s, delta_lambda);
  if (report.outcome == SolveOutcome::converged || report.outcome == SolveOutcome::iteration_limit)
    system.apply(rod, delta_lambda);
  return report;
}

DirectSolve::DirectSolve(const Scene& scene) : scene_(scene), factors_(scene.rods.begin(), scene.rods.end()) {}

SolveOutcome DirectSolve::solve(const LinearSystem& system, const SolvePosition& at, double, VectorX& delta_lambda) {
  const auto rod = static_cast<std::size_t>(at.rod);
  return factors_[rod].solve(scene_.rods[rod], system, delta_lambda);
}

}  // namespace rodsweep
