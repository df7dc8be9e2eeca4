// The balance of momentum of several equal chains at once (momentum_balance.hpp), rod r in lane r: g, the stiffening of
// rotations, and the terms of both in b and in the moves. Lanes that do not keep the balance have g = 0 and the
// mobility without stiffening.
#pragma once

#include <vector>

#include "solver/batch/batched_linearization.hpp"
#include "solver/rod/momentum_balance.hpp"

namespace rodsweep {

class BatchedBalance {
 public:
  BatchedBalance(const std::vector<Scene>& scenes, const BatchedRods& rods);

  /// Sets g, M + K of the rods, and b + J (M + K)^-1 g at the linearisation's positions, in the lanes `kept`.
  void assemble(BatchedRods& rods, BatchedLinearization& at, const LaneMask& kept);

  const Lane& residual() const { return residual_; }  ///< MomentumBalance::residual; 0 without the balance
  const LaneMask& kept() const { return kept_; }
  const Wrench<Lane>& defect(std::size_t segment) const { return segments_[segment].defect; }

 private:
  struct OfSegment {
    Inertia<Lane> inertia;
    Lane inverse_squared_length;  ///< 1/L^2
    Wrench<Lane> defect;          ///< g
  };
  std::vector<OfSegment> segments_;
  Lane least_;  ///< lower bound of the residual's reference
  Lane residual_;
  LaneMask kept_;
};

}  // namespace rodsweep
