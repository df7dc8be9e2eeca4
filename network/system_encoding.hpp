// The linear system of a correction as features without units: the encoding `system`.
//
// Per joint, in the places of a JointForest, from A^ d^ = r^ (network/scaled_system.hpp):
//   r^ (6), the off-diagonal entries of its diagonal block of A^ (15), its block with its parent joint (36; 0 at
//   roots).
// They determine a chain's d^ completely, and are the same for a rod scaled in length, mass or time. Couplings between
// siblings at a branching are left out.
#pragma once

#include "network/scaled_system.hpp"

namespace rodsweep {

class SystemEncoding {
 public:
  static constexpr int size = 57;

  SystemEncoding(const JointForest& forest, const BlockMatrix& a) : pattern_(system_pattern(forest, a)) {}

  /// Writes the features [57, places] and the scale of correction_scale(). Allocates nothing.
  void encode(const BlockMatrix& a, const VectorX& residual, Eigen::Ref<Tensor<float>> features, VectorX& scale) const;

  const SystemPattern& pattern() const { return pattern_; }

 private:
  SystemPattern pattern_;
};

}  // namespace rodsweep
