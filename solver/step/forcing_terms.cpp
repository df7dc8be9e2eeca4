#include "solver/step/forcing_terms.hpp"

#include <algorithm>

namespace rodsweep {

ForcingTerms::ForcingTerms(int rods, double first, double newton_tolerance)
    : first_(first), newton_tolerance_(newton_tolerance), last_(at(rods)) {}

double ForcingTerms::next(int rod, int newton, double norm, double residual) {
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

}  // namespace rodsweep
