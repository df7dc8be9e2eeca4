// Pod's guess (subspace_guess.hpp), and the same span projected out of every residual of the CG that starts from it:
//   x0 = V E^-1 V^T b,   z <- z - V E^-1 (A V)^T z,   E = V^T A V,
// deflated CG (Saad et al. 2000). All search directions are A-orthogonal to the stored solutions: what CG would find of
// them again, at the small eigenvalues that it finds last, it need not look for. It costs A V, as many products as
// there are solutions, and in every iteration two passes over V.
#pragma once

#include <vector>

#include "solver/guess/initial_guess.hpp"
#include "solver/guess/normal_equations.hpp"
#include "solver/linear/stored_vectors.hpp"

namespace rodsweep {

class DeflatingGuess : public InitialGuess, private Deflation {
 public:
  /// Of the newest `size` solutions of a (rod, Newton iteration), at least 1. As with extrapolation, a time step
  /// without a solution starts the history again.
  DeflatingGuess(const Scene& scene, int newton_iterations, int size);
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const SolvePosition& at, const VectorX& solution) override;
  Deflation* deflation() override { return current_ != nullptr ? this : nullptr; }

 private:
  struct History {
    StoredVectors solutions;
    int known = 0, newest = -1, last_step = -2;
  };
  History& history(const SolvePosition& at);
  void project(double* z) override;
  /// c <- E^-1 c, in the order of V.
  void solve(VectorX& c);

  int newton_iterations_, size_;
  std::vector<History> histories_;
  std::vector<StoredVectors> products_;  ///< per rod: A V
  History* current_ = nullptr;           ///< of the system last proposed for; null where it has none
  StoredVectors* current_products_ = nullptr;
  Eigen::MatrixXd gram_;
  VectorX right_side_, coefficients_;
  NormalEquations equations_;
};

}  // namespace rodsweep
