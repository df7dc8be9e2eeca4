// The linear system of a correction as features without units: the encoding `linear_system`.
//
// Per joint, in the places of a JointForest, of A^ d^ = r^ (network/encoding/scaled_system.hpp) in canonical frames
// (network/encoding/canonical_frames.hpp):
//   r^ (6), the upper triangle of the joint's diagonal block of A^ without the diagonal (15), its block with its
//   parent (36; 0 at roots)
// They determine d^ of a chain completely. Scaling a rod in length, mass or time, rotating or mirroring it, and rolling
// segments' frames about their axes do not change them. They omit couplings between siblings at a branching and across
// the cut of a loop.
#pragma once

#include "network/encoding/canonical_frames.hpp"

namespace rodsweep {

class SystemEncoding {
 public:
  static constexpr int size = 57, coupling = 21;  ///< features, and the first feature of the block with the parent

  SystemEncoding(const SystemPattern& pattern, Alignment alignment) : frames_(pattern, alignment) {}

  /// Writes the features [57, places]. Allocates nothing.
  void encode(const SystemPattern& pattern, const BlockMatrix& a, const VectorX& residual,
              Eigen::Ref<Tensor<float>> features);

  /// Finds only the frames.
  void find(const SystemPattern& pattern, const BlockMatrix& a, const VectorX& residual) {
    frames_.find(pattern, a, residual);
  }
  const CanonicalFrames& frames() const { return frames_; }

  /// d in the joint's frame from the network's output d^ for a place, and the inverse, for the system last encoded.
  Lane8 from_unit(int place, const Lane8& answer) const;
  Lane8 to_unit(int place, const Lane8& correction) const;

 private:
  CanonicalFrames frames_;
};

/// The same features of scaled systems side by side, with the parents of `forest`: [57, places].
template <class T>
Tensor<T> system_features(const ScaledSystem<T>& systems, const JointForest& forest);

}  // namespace rodsweep
