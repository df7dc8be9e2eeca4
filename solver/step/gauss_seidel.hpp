// Projections that correct one joint after the other, each at the positions after the corrections before it: the family
// of `pbd` and `xpbd`. One call of project() is one iteration; the time step's Newton loop counts them, so
// StepSettings::newton_iterations is the number of iterations per step.
//
// Joints are corrected in bilateral interleaving order (Umetani, Schmidt & Stam 2014; Kugelstadt & Schoemer 2016): even
// ones from the first, odd ones from the last, alternately, so that neither end of a chain is favoured. Any graph of
// joints is allowed, trees and closed loops included, because the correction of a joint does not use its neighbours.
//
// The residual of an iteration is the largest |C + alpha~ lambda|, each evaluated just before the correction of its
// joint, at no extra cost. Nothing allocates after construction.
#pragma once

#include <vector>

#include "solver/step/projection.hpp"

namespace rodsweep {

/// 0, m - 1, 2, m - 3, ... for an even number m of joints, 0, m - 2, 2, m - 4, ... for an odd one.
std::vector<int> bilateral_order(int joints);

class GaussSeidelProjection : public Projection {
 public:
  /// Throws SceneError if a joint joins two static segments.
  explicit GaussSeidelProjection(const Scene& scene);

  /// `not_run` if the residual was below `newton_tolerance` (the corrections of the iteration are kept), `not_a_number`
  /// if it is not finite, `indefinite` if a joint's block is not positive definite.
  ProjectionReport project(Rod& rod, const SolvePosition& at, double dt, double newton_tolerance) final;

 protected:
  struct Iteration {
    double residual = 0;   ///< max |C + alpha~ lambda| met
    bool definite = true;  ///< all blocks were positive definite

    void meet(const Vector6& met);
  };

 private:
  /// Corrects the joints of the rod in this order. Called once per iteration.
  virtual Iteration iterate(Rod& rod, const std::vector<int>& order, double dt) const = 0;

  std::vector<std::vector<int>> orders_;  ///< of every rod
};

}  // namespace rodsweep
