// The tolerance of a Newton iteration's linear solve: forcing terms of Eisenstat & Walker (1996, SIAM J. Sci. Comput.
// 17, choice 2 with its safeguard), relative residuals eta_j of the linear solve,
//   eta_0 given,   eta_j = gamma (|b_j| / |b_{j-1}|)^2,   gamma = 0.9,
// at least gamma eta_{j-1}^2 if that exceeds 0.1, at most eta_0, and not below the tolerance at which the residual
// is half of Newton's own tolerance. Convergence is superlinear; with a fixed tolerance it is linear.
#pragma once

#include <algorithm>
#include <vector>

#include "solver/numbers/types.hpp"

namespace rodsweep {

class ForcingTerms {
 public:
  ForcingTerms(int rods, double first, double newton_tolerance)
      : first_(first), newton_tolerance_(newton_tolerance), last_(at(rods)) {}

  /// eta of this iteration's solve, to be called once per iteration, in order; `norm` is |b|, `residual` max |b|.
  double next(int rod, int newton, double norm, double residual) {
    constexpr double gamma = 0.9, heeded = 0.1;
    Last& last = last_[at(rod)];
    double eta = first_;
    if (newton > 0 && last.norm > 0) {
      const double fallen = norm / last.norm, before = gamma * last.eta * last.eta;
      eta = gamma * fallen * fallen;
      if (before > heeded) eta = std::max(eta, before);
    }
    if (residual > 0) eta = std::max(eta, 0.5 * newton_tolerance_ / residual);
    eta = std::min(eta, first_);
    last = {norm, eta};
    return eta;
  }

 private:
  struct Last {
    double norm = 0, eta = 0;
  };
  double first_, newton_tolerance_;
  std::vector<Last> last_;  ///< per rod
};

}  // namespace rodsweep
