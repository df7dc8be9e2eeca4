// Gives another guess a history of whole steps: the sum of a step's increments replaces the solution of its first
// Newton iteration,
//   x_n = sum_j dlambda_j of step n.
// In a closed loop the first iteration's solution is inexact, and later iterations correct it: the sum is the best
// known change of the step. It is complete at the next step's first system, when prepare() passes it to the inner guess
// (accept_total). The inner guess accepts the solution of every system as without totals, and later iterations keep
// their own histories.
#pragma once

#include <memory>
#include <vector>

#include "solver/guess/initial_guess.hpp"

namespace rodsweep {

class TotalsGuess : public InitialGuess {
 public:
  TotalsGuess(const Scene& scene, std::unique_ptr<InitialGuess> inner);
  void prepare(const SolvePosition& at) override;
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override {
    return inner_->propose(system, at, x0);
  }
  void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) override;
  Deflation* deflation() override { return inner_->deflation(); }

 private:
  struct Total {
    VectorX sum;
    int step = -1;     ///< of the sum
    bool told = true;  ///< whether the inner guess received it
  };
  std::unique_ptr<InitialGuess> inner_;
  std::vector<Total> totals_;  ///< per rod
};

}  // namespace rodsweep
