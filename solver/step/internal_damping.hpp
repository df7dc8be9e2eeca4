// Kelvin-Voigt damping of a rod's material: stress E (eps + tau d eps / dt) in bending, twisting and, where the rod
// stretches, in stretch and shear. A joint's constraint C then also carries tau dC/dt, taken at the end of the step like
// all forces (free_flight.hpp: h; C^ = C_n, with BDF2 (4 C_n - C_(n-1)) / 3):
//
//   C + tau (C - C^) / h + alpha~ lambda = 0,   or, over 1 + tau / h,   C - (1 - y) C^ + y alpha~ lambda = 0
//
// with y = 1 / (1 + tau / h). So A keeps its pattern, with y alpha~ for alpha~, and b has a term more (Rod::damping). C
// does not change when a rod turns as a whole, so only strain is damped, and momentum is kept. At rest nothing changes.
// A mode of frequency w decays at the rate w^2 tau / 2. The stretch-shear rows of inextensible joints are not a material's
// and are not damped.
#pragma once

#include "solver/rod/linearization.hpp"

namespace rodsweep {

class InternalDamping {
 public:
  /// Sizes rod.damping. tau > 0 [s].
  InternalDamping(Rod& rod, double tau_s);

  /// Call with the rod as it is at the start of the step.
  void remember(const Rod& rod);
  /// Sets rod.damping for a step with h.
  void start(Rod& rod, double h, bool two_steps) const;

 private:
  double tau_s_;
  Linearization now_;
  VectorX before_;  ///< C at the start of the last step
};

}  // namespace rodsweep
