// A guess without products: today's right-hand side is regressed on those of the last systems, and the solutions are
// combined with the same coefficients,
//   x0 = sum_k c_k x_k,   c = argmin |W (b - sum_k c_k b_k)|^2 + noise^2 sum_k c_k^2 |W b_k|^2,   W = D^-1/2,
// D the diagonal of A where the history began, `noise` the relative error of the stored solutions: of large
// coefficients of opposite signs, which near-equal right-hand sides invite, it would be most of what remains
// (Tikhonov). Where A did not change, this is exact for every b in the span of the b_k; where it does, SubspaceGuess is
// the best that the same solutions allow, at a product with A for each.
//
// The normal equations cost one pass over the stored right-hand sides: their dot products with each other are those of
// earlier steps.
#pragma once

#include <vector>

#include "solver/guess/initial_guess.hpp"
#include "solver/guess/normal_equations.hpp"

namespace rodsweep {

class RegressionGuess : public InitialGuess {
 public:
  /// On the last `size` systems of one (rod, Newton iteration), at least 1; `noise` is the tolerance that they were
  /// solved to, 0 where directly. As with extrapolation, a time step without a solution starts the history again.
  RegressionGuess(const Scene& scene, int newton_iterations, int size, double noise);
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const SolvePosition& at, const VectorX& solution) override;

 private:
  using Matrix = Eigen::MatrixXd;
  struct History {
    VectorX weight;                 ///< W
    Matrix right_sides, solutions;  ///< W b_k and x_k, one a column
    Matrix gram;                    ///< dot products of the right-hand sides
    int known = 0, newest = -1, last_step = -2;
    /// The system last proposed for: W b, and its dot products with the stored ones and itself.
    VectorX right_side, products;
    double squared_norm = 0;
  };
  History& history(const SolvePosition& at);

  int newton_iterations_, size_;
  double noise_;
  std::vector<History> histories_;
  NormalEquations equations_;
  VectorX coefficients_;  ///< of the columns
};

}  // namespace rodsweep
