#include "network/guess/factor_preconditioner.hpp"

#include <algorithm>
#include <stdexcept>

namespace rodsweep {

static const Model& with_factors(const Model& model) {
  if (model.net.settings().processor != Processor::factors)
    throw std::invalid_argument("FactorPreconditioner: the model has no factors");
  return model;
}

FactorPreconditioner::FactorPreconditioner(std::shared_ptr<const Model> model, const Rod& rod,
                                           const LinearSystem& system)
    : model_(std::move(model)),
      rod_(rod),
      system_(system),
      encoder_(model_->net.settings(), rod, system.matrix()),
      factors_(with_factors(*model_), encoder_),
      nodes_(node_features(model_->net.settings()), rod.segment_count()),
      edges_(edge_features(model_->net.settings()), rod.joint_count()),
      zero_(VectorX::Zero(system.matrix().unknowns())),
      r_(zero_),
      z_(zero_) {}

bool FactorPreconditioner::set_up(const BlockMatrix& a) {
  encoder_.encode(rod_, system_, 0, zero_, system_.rhs(), nodes_, edges_);  // factors do not see the residual
  factors_.factorise(encoder_, edges_, a, true);
  return true;
}

void FactorPreconditioner::apply(const double* r, double* z) {
  std::copy_n(r, r_.size(), r_.data());
  factors_.solve(r_, z_);
  std::copy_n(z_.data(), z_.size(), z);
}

}  // namespace rodsweep
