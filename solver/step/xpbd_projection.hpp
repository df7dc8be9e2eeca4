// Extended position-based dynamics (Macklin, Mueller & Chentanez 2016): Gauss-Seidel over the joints, with compliances
// and accumulated multipliers, on the constraints and alpha~ of the linear system (linearization.hpp).
//
// A joint's six rows are solved together, linearised at the current positions:
//   (J M^-1 J^T + alpha~) dlambda = -C - alpha~ lambda    of that joint alone (6x6)
//   lambda += dlambda,   (u, phi) = M^-1 J^T dlambda of its two segments
// The paper solves row by row. A block converges in fewer iterations, because stretch-shear and bend-twist of a joint
// act on the same segments. A fixed point is also one of Newton's iteration, C + alpha~ lambda = 0. But forces act
// along J at the positions in between, so the results of a step differ by O(dt^4) in positions, O(dt^3) in velocities.
#pragma once

#include "solver/step/gauss_seidel.hpp"

namespace rodsweep {

class XpbdProjection : public GaussSeidelProjection {
 public:
  using GaussSeidelProjection::GaussSeidelProjection;

 private:
  Iteration iterate(Rod& rod, const std::vector<int>& order, double dt) const override;
};

}  // namespace rodsweep
