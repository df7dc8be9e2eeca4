// The linear system of a correction as features without units: the encoding `system`.
//
// Per joint, in the places of a JointForest, from A^ d^ = r^ (network/encoding/scaled_system.hpp):
//   r^ (6), the off-diagonal entries of its diagonal block of A^ (15), its block with its parent joint (36; 0 at
//   roots).
// They determine a chain's d^ completely, and are the same for a rod scaled in length, mass or time. Couplings between
// siblings at a branching are left out, and those across the cut of a loop.
#pragma once

#include <utility>

#include "network/encoding/scaled_system.hpp"

namespace rodsweep {

class SystemEncoding {
 public:
  static constexpr int size = 57, coupling = 21;  ///< features, and the one that the block with the parent begins at

  explicit SystemEncoding(SystemPattern pattern) : pattern_(std::move(pattern)) {}

  /// Writes the features [57, places] and the scale of correction_scale(). Allocates nothing.
  void encode(const BlockMatrix& a, const VectorX& residual, Eigen::Ref<Tensor<float>> features, VectorX& scale) const;

 private:
  SystemPattern pattern_;
};

/// The same features of scaled systems side by side, of one encoding or another, whose places hang together as `forest`
/// says: [57, places].
template <class T>
Tensor<T> system_features(const ScaledSystem<T>& systems, const JointForest& forest);

}  // namespace rodsweep
