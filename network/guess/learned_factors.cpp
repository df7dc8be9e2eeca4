#include "network/guess/learned_factors.hpp"

namespace rodsweep {

LearnedFactors::LearnedFactors(const Model& model, const FeatureEncoder& encoder) {
  const CopingNet<float>& net = model.net;
  if (has_all_couplings(net.settings()))
    coupled_ = std::make_unique<CoupledInference>(net.coupled(), net.parameters(), encoder.pattern());
  else
    tree_ = std::make_unique<FactorInference>(net.factors(), net.parameters(), encoder.topology().forest,
                                              encoder.pattern());
}

void LearnedFactors::factorise(const FeatureEncoder& encoder, const Tensor<float>& edges, const BlockMatrix& a,
                               bool positive) {
  if (coupled_)
    coupled_->factorise(encoder.system()->frames(), a);
  else
    tree_->factorise(edges, encoder.system()->frames(), a, positive);
}

void LearnedFactors::solve(const VectorX& r, VectorX& z) {
  if (coupled_)
    coupled_->solve(r, z);
  else
    tree_->solve(r, z);
}

}  // namespace rodsweep
