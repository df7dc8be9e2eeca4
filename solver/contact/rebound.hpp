// The separation by an impact in a step of dt, in lengths over a step: gap g at its start, approach v dt before the step's
// forces, acceleration of the approach a dt^2. The law is that of the energy, exact for a constant a:
//
//   v'^2 / 2 + b v' + a g + c = e^2 (v^2 / 2 + b0 v + a g)
//
// The height that bodies reach, or fell from, differs from v^2 / 2a by the steps' own error: a step of implicit Euler
// starts at the speed of its end, b = b0 = a / 2, c = 0. BDF2 is exact before the impact, b0 = 0; the step of the impact
// and the next two are Euler's (free_flight.hpp), then b = a, and c = -5/4 a^2 is the displacement that these lack.
// Moreau's v' = e v is its limit for small steps, and holds for any without acceleration.
//
// If bodies would meet again in the next step or (BDF2) the one after it, v' < b, they stay together: e^2 of nearly
// nothing is rest.
#pragma once

#include <cmath>

namespace rodsweep {

/// v' dt [m]; 0: no rebound.
inline double rebound(double restitution, double approach, double gap, double acceleration, bool two_steps) {
  if (!(approach + acceleration > 0)) return 0;  // they part
  const double a = acceleration, b = two_steps ? a : a / 2, before = two_steps ? 0 : a / 2;
  const double lacking = two_steps ? 1.25 * a * a : 0;
  const double energy = restitution * restitution * (approach * approach / 2 + before * approach + a * gap);
  const double square = b * b + 2 * (energy - a * gap + lacking);
  const double apart = square > 0 ? std::sqrt(square) - b : 0;
  return apart > b ? apart : 0;
}

}  // namespace rodsweep
