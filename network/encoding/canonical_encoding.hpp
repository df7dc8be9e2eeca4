// The linear system of a correction as features that turning, rolling and mirroring leave alone: the encoding
// `canonical`. The numbers are those of system_encoding.hpp in the frames of canonical_frames.hpp.
#pragma once

#include "network/encoding/canonical_frames.hpp"
#include "network/encoding/system_encoding.hpp"

namespace rodsweep {

class CanonicalEncoding {
 public:
  static constexpr int size =
      SystemEncoding::size;  ///< r^ (6), the upper triangle of A^_kk without its diagonal (15), A^_k,parent (36)

  CanonicalEncoding(const SystemPattern& pattern, Alignment alignment) : frames_(pattern, alignment) {}

  /// Writes the features [57, places]. Allocates nothing.
  void encode(const SystemPattern& pattern, const BlockMatrix& a, const VectorX& residual,
              Eigen::Ref<Tensor<float>> features);

  /// Finds the frames alone.
  void find(const SystemPattern& pattern, const BlockMatrix& a, const VectorX& residual) {
    frames_.find(pattern, a, residual);
  }
  const CanonicalFrames& frames() const { return frames_; }

  /// d of a network's answer d^ for a place, in the joint's frame, or back, of the system last encoded.
  Lane8 from_unit(int place, const Lane8& answer) const;
  Lane8 to_unit(int place, const Lane8& correction) const;

 private:
  CanonicalFrames frames_;
};

}  // namespace rodsweep
