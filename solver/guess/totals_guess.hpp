// Gives another guess a history of whole steps: the sum of a step's increments replaces the solution of its first
// Newton iteration,
//   x_n = sum_j dlambda_j of step n.
// In a closed loop the first iteration's solution is inexact, and later iterations correct it: the sum is the best
// known change of the step. It is complete at the next step's first system, when prepare() passes it to the inner guess
// (accept_total). The inner guess accepts the solution of every system as without totals, and later iterations keep
// their own histories.
#pragma once

#include <vector>

#include "solver/guess/wrapped_guess.hpp"

namespace rodsweep {

class TotalsGuess : public WrappedGuess {
 public:
  TotalsGuess(const Scene& scene, std::unique_ptr<InitialGuess> inner);
  void prepare(const SolvePosition& at) override;
  void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) override;
  void accept_total(int, int, const VectorX&) override {}  // its own sums are more recent

 private:
  struct Total {
    VectorX sum;
    int step = -1;     ///< of the sum
    bool told = true;  ///< whether the inner guess received it
  };
  std::vector<Total> totals_;  ///< per rod
};

}  // namespace rodsweep
