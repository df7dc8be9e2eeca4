// Projections that correct one joint after the other, each at the positions that the joints before it left: the family
// of `pbd` and `xpbd`. One call of project() is one iteration; the time step's Newton loop counts them, so
// StepSettings::newton_iterations is the number of iterations per step.
//
// Joints take turns in bilateral interleaving order (Umetani, Schmidt & Stam 2014; Kugelstadt & Schoemer 2016): even
// ones from the first, odd ones from the last, alternately, so that neither end of a chain is favoured. Any graph of
// joints will do, trees and closed loops included, since no joint needs to know its neighbours.
//
// The residual of an iteration is the largest |C + alpha~ lambda| that it met, every joint's just before its own
// correction: it costs nothing. Nothing allocates after construction.
#pragma once

#include <vector>

#include "solver/step/projection.hpp"

namespace rodsweep {

/// 0, m - 1, 2, m - 3, ... of an even number m of joints, 0, m - 2, 2, m - 4, ... of an odd one.
std::vector<int> bilateral_order(int joints);

class GaussSeidelProjection : public Projection {
 public:
  /// Throws SceneError where a joint joins two static segments.
  explicit GaussSeidelProjection(const Scene& scene);

  /// `not_run` where the residual met was below `newton_tolerance`: what little the iteration did stays done.
  /// `not_a_number` where it is none, `indefinite` where a joint's own block was.
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
