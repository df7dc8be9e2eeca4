// Projected initial guesses: the best approximation, in the energy norm, of the solution within the span of earlier
// ones (Fischer 1998, Comput. Methods Appl. Mech. Engrg. 163), for the current matrix A:
//   x0 = V E^-1 V^T b,   E = V^T A V,   V the stored solutions of one (rod, Newton iteration).
// A changes from solve to solve, so A V is formed again: as many products with A as there are solutions, all in one
// pass (stored_vectors.hpp). Newer solutions go before older ones (normal_equations.hpp).
//
// With deflation, CG also projects the same span out of every residual r (deflation.hpp),
//   c = E^-1 V^T r,  r <- r - A V c;   z <- z - V (E^-1 (A V)^T z - c):
// Then search directions are A-orthogonal to all stored solutions, so CG does not find these components again. They
// belong to the small eigenvalues, which CG finds last. Deflation drops solutions that newer ones nearly span (pivot
// below 1e-6), which the guess itself uses. An iteration costs four more passes over V.
#pragma once

#include <vector>

#include "solver/guess/initial_guess.hpp"
#include "solver/guess/normal_equations.hpp"
#include "solver/linear/stored_vectors.hpp"

namespace rodsweep {

class SubspaceGuess : public InitialGuess, private Deflation {
 public:
  enum class Window {
    restarted,  ///< `fischer`: solutions are collected until there are `size`, then the newest starts a new set
    sliding  ///< `subspace`: the newest `size` solutions, the space of a proper orthogonal decomposition with all modes
  };
  enum class Use { guess, guess_and_deflation };
  /// `size` of at least 1. As with extrapolation, a time step without a solution starts the history again.
  SubspaceGuess(const Scene& scene, int newton_iterations, int size, Window window, Use use = Use::guess);
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const SolvePosition& at, const VectorX& solution) override;
  Deflation* deflation() override { return deflating_ ? this : nullptr; }

 private:
  struct History {
    StoredVectors solutions;
    int known = 0, newest = -1, last_step = -2;
  };
  History& history(const SolvePosition& at);
  int by_age(const History& h, int age) const { return (h.newest - age + size_) % size_; }
  void fill(const History& h, NormalEquations& equations);
  /// c <- E^-1 c, in the order of V.
  void solve(const History& h, NormalEquations& equations, VectorX& c);
  void reduce(double* r) override;
  void complete(double* z) override;

  int newton_iterations_, size_;
  Window window_;
  std::vector<History> histories_;
  Eigen::VectorXi order_;  ///< of V, the newest first; of the system last proposed for
  Eigen::MatrixXd gram_;   ///< E
  VectorX coefficients_;   ///< V^T b, then c, in the order of V
  NormalEquations equations_, deflating_equations_;
  VectorX of_residual_;                  ///< V^T r, then E^-1 of it
  std::vector<StoredVectors> products_;  ///< per rod: A V; empty unless deflating
  History* deflating_ = nullptr;         ///< of the system last proposed for, if deflating
  StoredVectors* deflating_products_ = nullptr;
};

}  // namespace rodsweep
