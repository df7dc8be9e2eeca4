// Frames in which a linear system looks the same however the scene is turned, mirrored, or its segments' frames are
// rolled about their own axes (which nobody can tell of a circular section).
//
// A joint's rows are in its own frame, whose z is along the rod; what is arbitrary is the roll about z, and the hand.
// With transverse pairs (x, y) as complex numbers, the frame of joint k is rolled by the unit number t_k:
//   along a tree  t_k = t_parent conj(u),  u = -(B_00 + B_11 + i (B_10 - B_01)) / |.|,  B the transverse bend block of
//                 the coupling of k with its parent: frames are carried along the rod without roll
//   as a whole    every tree is rolled so that the axis of largest second moment of its residual,
//                 sqrt(sum (t s_k)^2 - (t m_k)^2), is x, towards sum t s_k; s_k, m_k are the transverse residuals of
//                 stretch-shear and of bending (in planar motion in its plane, and across it)
//   mirrored      across the xz plane, where the residuals of twist have a negative sum, or where there are none and
//                 sum t s_k is on the right of x; rows of bend and twist are those of an axis, which a mirror turns the
//                 other way
// T_k = diag(R(t_k), 1, R(t_k), 1), then signs. Residuals are scaled by scale(), which is one number for both
// transverse rows of a kind, so that it does not know the roll either.
#pragma once

#include "network/encoding/scaled_system.hpp"

namespace rodsweep {

/// T of one joint: T v = along v + across v', v' with x and y exchanged.
struct CanonicalFrame {
  Lane8 along, across;

  Lane8 operator()(const Lane8& v) const {
    return along * v + across * __builtin_shufflevector(v, v, 1, 0, 2, 4, 3, 5, 6, 7);
  }
  /// T^T v.
  Lane8 back(const Lane8& v) const {
    const Lane8 w = across * v;
    return along * v + __builtin_shufflevector(w, w, 1, 0, 2, 4, 3, 5, 6, 7);
  }
};

/// T_row block T_column^T.
Block6 seen(const Block6& block, const CanonicalFrame& row, const CanonicalFrame& column);

class CanonicalFrames {
 public:
  explicit CanonicalFrames(const SystemPattern& pattern);

  /// Sets the frames and scales of a system and its residual. Allocates nothing.
  void find(const SystemPattern& pattern, const BlockMatrix& a, const VectorX& residual);

  const CanonicalFrame& frame(int place) const { return frames_[static_cast<std::size_t>(place)]; }
  /// S of a place's joint: d = rho S T^T d^ and A^ = S T A T^T S, as in scaled_system.hpp.
  const Lane8& scale(int place) const { return scales_[static_cast<std::size_t>(place)]; }
  double rho() const { return rho_; }  ///< root mean square of S r

 private:
  struct Tree {
    double second_x, second_y, first_x, first_y, twist;
  };
  std::vector<int> tree_;  ///< of each place
  std::vector<Tree> trees_;
  std::vector<CanonicalFrame> frames_;
  std::vector<Lane8> scales_;
  std::vector<double> roll_x_, roll_y_;  ///< t
  double rho_ = 0;
};

/// The system of a correction as scaled_system() has it, in these frames.
ScaledSystem<float> canonical_system(const SystemPattern& pattern, const CanonicalFrames& frames, const BlockMatrix& a,
                                     const VectorX& residual, const VectorX& error, double solution_energy);

}  // namespace rodsweep
