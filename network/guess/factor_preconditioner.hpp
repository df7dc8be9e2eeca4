// The learned factors of a rod's matrix as preconditioner of CG: z = F r (learned_factors.hpp). F is symmetric,
// and made positive definite. Learned preconditioners of other kinds: Li et al. 2023 (NeuralPCG), Häusner et al. 2023
// (NeuralIF), Trifonov et al. 2024 (PreCorrector).
#pragma once

#include <memory>

#include "network/guess/learned_factors.hpp"
#include "solver/cg/block_preconditioner.hpp"
#include "solver/linear/linear_system.hpp"

namespace rodsweep {

class FactorPreconditioner : public BlockPreconditioner {
 public:
  /// `rod` and `system` must outlive it. Throws std::invalid_argument if the model has no factors.
  FactorPreconditioner(std::shared_ptr<const Model> model, const Rod& rod, const LinearSystem& system);

  /// Predicts the factors of the system as it is assembled, whose matrix is `a`. Always returns true.
  bool set_up(const BlockMatrix& a) override;
  void apply(const double* r, double* z) override;

 private:
  std::shared_ptr<const Model> model_;
  const Rod& rod_;
  const LinearSystem& system_;
  FeatureEncoder encoder_;
  LearnedFactors factors_;
  Tensor<float> nodes_, edges_;
  VectorX zero_, r_, z_;
};

}  // namespace rodsweep
