// Uses another guess only if sqrt(r^T D^-1 r) of r = b - A x0 is below `threshold` times that of b, D the diagonal
// of A (the natural norm of Jacobi-preconditioned CG); else zero.
#pragma once

#include <vector>

#include "solver/guess/wrapped_guess.hpp"

namespace rodsweep {

class GuardedGuess : public WrappedGuess {
 public:
  GuardedGuess(const Scene& scene, std::unique_ptr<InitialGuess> inner, double threshold)
      : WrappedGuess(std::move(inner)), threshold_(threshold), residual_(unknowns_of(scene)) {}
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;

 private:
  double threshold_;
  std::vector<VectorX> residual_;  ///< per rod
};

}  // namespace rodsweep
