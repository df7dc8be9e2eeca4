// Projected initial guesses: the best approximation, in the energy norm, of the solution within the span of earlier
// ones (Fischer 1998, Comput. Methods Appl. Mech. Engrg. 163), always of the current matrix A:
//   x0 = V c,   (V^T A V) c = V^T b,   V the stored solutions of one (rod, Newton iteration).
// A changes from solve to solve, so A V is formed anew: as many products with A as there are solutions, all in one pass
// (stored_vectors.hpp). Newer solutions go before older ones (normal_equations.hpp).
#pragma once

#include <vector>

#include "solver/guess/initial_guess.hpp"
#include "solver/guess/normal_equations.hpp"
#include "solver/linear/stored_vectors.hpp"

namespace rodsweep {

class SubspaceGuess : public InitialGuess {
 public:
  enum class Window {
    restarted,  ///< `fischer`: solutions are collected until there are `size`, then the newest starts a new set
    sliding     ///< `pod`: the newest `size` solutions, the space of a proper orthogonal decomposition with all modes
  };
  /// `size` of at least 1. As with extrapolation, a time step without a solution starts the history again.
  SubspaceGuess(const Scene& scene, int newton_iterations, int size, Window window);
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const SolvePosition& at, const VectorX& solution) override;

 private:
  struct History {
    StoredVectors solutions;
    int known = 0, newest = -1, last_step = -2;
  };
  History& history(const SolvePosition& at);

  int newton_iterations_, size_;
  Window window_;
  std::vector<History> histories_;
  Eigen::MatrixXd gram_;               ///< V^T A V, lower triangle
  VectorX right_side_, coefficients_;  ///< V^T b and c, in the order of V
  NormalEquations equations_;
};

}  // namespace rodsweep
