// Another guess, with a history of whole steps: for the first Newton iteration it hears, in place of that iteration's
// own solutions, the sum of a step's increments,
//   x_n = sum_j dlambda_j of step n.
// In a closed loop an iteration's solution is as inexact as its solve, and the iterations after it correct it: what the
// first system of the step needed is known best at its end. That is known at the next step's first system: the inner
// guess hears of it in prepare(). Later iterations keep their own histories.
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
  void accept(const SolvePosition& at, const VectorX& solution) override;
  Deflation* deflation() override { return inner_->deflation(); }

 private:
  struct Total {
    VectorX sum;
    int step = -1;     ///< of the sum
    bool told = true;  ///< whether the inner guess knows it
  };
  std::unique_ptr<InitialGuess> inner_;
  std::vector<Total> totals_;  ///< per rod
};

}  // namespace rodsweep
