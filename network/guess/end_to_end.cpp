#include "network/guess/end_to_end.hpp"

#include <cmath>

#include "network/guess/base_guess.hpp"

namespace rodsweep {

CopingNetIncrements::CopingNetIncrements(std::shared_ptr<const Model> model, const Scene& scene, int newton_iterations)
    : model_(std::move(model)),
      base_(base_guess(model_->net.settings(), scene, newton_iterations)),
      corrections_(scene.rods.size()) {}

bool CopingNetIncrements::predict(const Rod& rod, const LinearSystem& system, const SolvePosition& at,
                                  VectorX& delta_lambda, std::vector<Lane8>& moves) {
  std::unique_ptr<CopingNetCorrection>& correction = corrections_[static_cast<std::size_t>(at.rod)];
  if (!correction) correction = std::make_unique<CopingNetCorrection>(model_, rod, system.matrix());
  const bool own_moves = model_->net.settings().moves;
  base_->prepare(at);
  Proposal proposal = base_->propose(system, at, delta_lambda);
  if (!correction->correct(rod, system, at, proposal, delta_lambda, own_moves ? &moves : nullptr)) return false;
  if (!own_moves) system.displacements(rod, delta_lambda, moves);
  base_->accept(system, at, delta_lambda);
  return delta_lambda.allFinite();
}

EndToEndProjection::EndToEndProjection(const Scene& scene, std::unique_ptr<IncrementSource> source)
    : source_(std::move(source)) {
  for (const Rod& rod : scene.rods)
    rods_.push_back(
        {LinearSystem(rod), VectorX::Zero(6 * rod.joint_count()), std::vector<Lane8>(rod.segments.size(), Lane8{})});
}

ProjectionReport EndToEndProjection::project(Rod& rod, const SolvePosition& at, double dt, double newton_tolerance) {
  RodBuffers& of = rods_[static_cast<std::size_t>(at.rod)];
  of.system.assemble(rod, dt);
  ProjectionReport report{SolveOutcome::not_run, of.system.newton_residual()};
  if (report.newton_residual < newton_tolerance) return report;
  report.outcome = SolveOutcome::not_a_number;
  if (!std::isfinite(report.newton_residual)) return report;
  if (!source_->predict(rod, of.system, at, of.delta_lambda, of.moves)) return report;
  displace(rod, of.moves, of.delta_lambda);
  report.outcome = SolveOutcome::converged;
  return report;
}

}  // namespace rodsweep
