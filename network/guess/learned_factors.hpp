// The factors that a model predicts for a rod's matrix, along a tree (network/processor/factor_sweeps.hpp) or of all
// couplings (coupled_factors.hpp): z = F r, symmetric. Allocates nothing after a first call.
#pragma once

#include <memory>

#include "network/encoding/feature_encoder.hpp"
#include "network/processor/coupled_inference.hpp"
#include "network/processor/factor_inference.hpp"
#include "network/processor/model.hpp"

namespace rodsweep {

class LearnedFactors {
 public:
  /// Those of a model with factors, which must outlive it.
  LearnedFactors(const Model& model, const FeatureEncoder& encoder);

  /// Predicts the factors of `a`, for which the encoder encoded `edges`. `positive`: F is positive definite; those of all
  /// couplings always are.
  void factorise(const FeatureEncoder& encoder, const Tensor<float>& edges, const BlockMatrix& a,
                 bool positive = false);
  void solve(const VectorX& r, VectorX& z);

 private:
  std::unique_ptr<FactorInference> tree_;
  std::unique_ptr<CoupledInference> coupled_;  ///< one of the two
};

}  // namespace rodsweep
