#include "network/guess/factor_preconditioner.hpp"

#include <algorithm>
#include <stdexcept>

namespace rodsweep {

FactorPreconditioner::FactorPreconditioner(std::shared_ptr<const Model> model, const Rod& rod,
                                           const LinearSystem& system)
    : model_(std::move(model)),
      rod_(rod),
      system_(system),
      encoder_(model_->net.settings(), rod, system.matrix()),
      nodes_(node_features(model_->net.settings()), rod.segment_count()),
      edges_(edge_features(model_->net.settings()), rod.joint_count()),
      zero_(VectorX::Zero(system.matrix().unknowns())),
      r_(zero_),
      z_(zero_) {
  const CopingNetSettings& settings = model_->net.settings();
  if (settings.processor != Processor::factors)
    throw std::invalid_argument("FactorPreconditioner: the model has no factors");
  if (has_all_couplings(settings))
    coupled_ = std::make_unique<CoupledInference>(model_->net.coupled(), model_->net.parameters(), encoder_.pattern());
  else
    factors_ = std::make_unique<FactorInference>(model_->net.factors(), model_->net.parameters(),
                                                 encoder_.topology().forest, encoder_.pattern());
}

bool FactorPreconditioner::set_up(const BlockMatrix& a) {
  encoder_.encode(rod_, system_, 0, zero_, system_.rhs(), nodes_, edges_);  // factors do not see the residual
  if (coupled_)
    coupled_->factorise(encoder_.system()->frames(), a);
  else
    factors_->factorise(edges_, encoder_.system()->frames(), a);
  return true;
}

void FactorPreconditioner::apply(const double* r, double* z) {
  std::copy_n(r, r_.size(), r_.data());
  if (coupled_)
    coupled_->solve(r_, z_);
  else
    factors_->solve(r_, z_);
  std::copy_n(z_.data(), z_.size(), z);
}

}  // namespace rodsweep
