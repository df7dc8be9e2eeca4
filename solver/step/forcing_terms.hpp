// The tolerance of a Newton iteration's linear solve: forcing terms of Eisenstat & Walker (1996, SIAM J. Sci. Comput.
// 17, choice 2 with its safeguard), relative residuals eta_j of the linear solve,
//   eta_0 given,   eta_j = gamma (|b_j| / |b_{j-1}|)^2,   gamma = 0.9,
// at least gamma eta_{j-1}^2 if that exceeds 0.1, at most eta_0, and not below the tolerance at which the residual
// is half of Newton's own tolerance. Convergence is superlinear; with a fixed tolerance it is linear.
#pragma once

#include <vector>

namespace rodsweep {

class ForcingTerms {
 public:
  ForcingTerms(int rods, double first, double newton_tolerance);

  /// eta of this iteration's solve, to be called once per iteration, in order; `norm` is |b|, `residual` max |b|.
  double next(int rod, int newton, double norm, double residual);

 private:
  struct Last {
    double norm = 0, eta = 0;
  };
  double first_, newton_tolerance_;
  std::vector<Last> last_;  ///< per rod
};

}  // namespace rodsweep
