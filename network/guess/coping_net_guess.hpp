// COPINGNet as an initial guess: a base guess, and the network's correction of it
// (network/guess/coping_net_correction.hpp).
//
// With `best_length` x0 is no worse than x_base in the energy norm for any output of the network. x0 is x_base if the
// output is not finite or the residual is zero.
#pragma once

#include <memory>
#include <vector>

#include "network/guess/coping_net_correction.hpp"

namespace rodsweep {

class CopingNetGuess : public InitialGuess {
 public:
  /// `scene` is the one that the solves move: features of graphs read the rods' state from it.
  CopingNetGuess(std::shared_ptr<const Model> model, const Scene& scene, int newton_iterations, FactorUse use = {});

  void prepare(const SolvePosition& at) override { base_->prepare(at); }
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) override {
    base_->accept(system, at, solution);
  }
  void accept_total(int rod, int step, const VectorX& total) override { base_->accept_total(rod, step, total); }

 private:
  std::shared_ptr<const Model> model_;
  const Scene& scene_;
  FactorUse use_;
  std::unique_ptr<InitialGuess> base_;
  std::vector<std::unique_ptr<CopingNetCorrection>> corrections_;  ///< made at a rod's first solve
};

}  // namespace rodsweep
