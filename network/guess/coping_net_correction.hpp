// The correction of a COPINGNet to a base guess of one rod's linear system:
//
//   x = x_base + c d,   d = unit * y(features of the rod, A, r),   r = b - A x_base,
//   c = d.r / d.A d with `best_length` or several corrections, else 1
//
// and, if the network predicts them, the segments' moves Delta p in their own frames, in metres and radians.
//
// Factors of a tree omit couplings across the cut of a loop. For a rod with loops, x_base is kept unless the residual
// also decreases in the natural norm sqrt(r^T D^-1 r).
//
// Factors (network/processor/factor_sweeps.hpp) apply to any residual. `corrections` counts steps of conjugate
// gradients with the factors as preconditioner; the first step is the correction above. In the joints' frames a matrix
// changes slowly, so factors may be reused for the solves of later time steps (`lag_steps`).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "network/guess/learned_factors.hpp"
#include "network/processor/model.hpp"
#include "solver/guess/initial_guess.hpp"

namespace rodsweep {

/// Options of a model with factors. Other models need the defaults.
struct FactorUse {
  int corrections = 1;
  int lag_steps = 0;   ///< time steps for which factors are reused; 0: one solve
  double stop_at = 0;  ///< correct no further if ||r||_2 <= this ||b||_2
};

class CopingNetCorrection {
 public:
  /// `a`: the matrix of the rod's systems. Throws std::invalid_argument if `use` is for factors and the model has none,
  /// or if its factors have a latent size without kernels.
  CopingNetCorrection(std::shared_ptr<const Model> model, const Rod& rod, const BlockMatrix& a, FactorUse use = {});

  /// Corrects x, which holds x_base, for the system assembled at the rod's state. Sets `moves`, per segment, if given
  /// (models with settings.moves only). Returns false and leaves x unchanged if the network's output is not finite.
  /// Adds its products with A to `proposal`, which describes x_base. Allocates nothing after a first call.
  bool correct(const Rod& rod, const LinearSystem& system, const SolvePosition& at, Proposal& proposal, VectorX& x,
               std::vector<Lane8>* moves);

 private:
  void run(const Rod& rod, const LinearSystem& system, const SolvePosition& at, const VectorX& x, bool with_moves);
  void answer(bool with_moves);
  bool factors_serve(const SolvePosition& at) const;
  double correct_again(const LinearSystem& system, double energy, double& length);
  bool write(std::vector<Lane8>& moves) const;

  std::shared_ptr<const Model> model_;
  FactorUse use_;
  bool may_harm_ = false;  ///< loops were cut
  std::optional<SolvePosition> factorised_at_;
  FeatureEncoder encoder_;
  std::optional<LearnedFactors> factors_;
  CopingNet<float>::Tape tape_;
  Tensor<float> nodes_, edges_, y_edges_, y_nodes_;
  VectorX residual_, d_, ad_, previous_, base_;
};

}  // namespace rodsweep
