// A guess without products: the current right-hand side is regressed on those of the last systems, and the solutions
// are combined with the same coefficients,
//   x0 = sum_k c_k x_k,   c = argmin |W (b - sum_k c_k b_k)|^2 + noise^2 sum_k c_k^2 |W b_k|^2,   W = D^-1/2,
// D the diagonal of A at the history's start, `noise` the relative error of the stored solutions. Nearly equal
// right-hand sides give large coefficients of opposite signs, which amplify that error; the second term prevents this
// (Tikhonov). If A did not change, this is exact for every b in the span of the b_k. If A changes, SubspaceGuess is the
// best combination of the same solutions, at a product with A for each.
//
// The normal equations cost one pass over the stored right-hand sides. Earlier steps give their dot products.
#pragma once

#include "solver/guess/history_guess.hpp"
#include "solver/guess/normal_equations.hpp"

namespace rodsweep {

struct SolvedSystems : RecentSteps {
  VectorX weight;                          ///< W
  Eigen::MatrixXd right_sides, solutions;  ///< W b_k and x_k, one per column
  Eigen::MatrixXd gram;                    ///< dot products of the right-hand sides
  /// The system last proposed for: W b, and its dot products with the stored ones and itself.
  VectorX right_side, products;
  double squared_norm = 0;
  void keep(const VectorX& solution) { solutions.col(newest) = solution; }
};

class RegressionGuess : public HistoryGuess<SolvedSystems> {
 public:
  /// From the last `size` >= 1 systems of one (rod, Newton iteration); `noise` is the tolerance of their solves, 0 for
  /// direct solves. As with extrapolation, a time step without a solution starts the history again.
  RegressionGuess(const Scene& scene, int newton_iterations, int size, double noise);
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;
  void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) override;

 private:
  double noise_;
  Eigen::VectorXi order_;  ///< of a history's solutions, the newest first
  NormalEquations equations_;
  VectorX coefficients_;  ///< one per column
};

}  // namespace rodsweep
