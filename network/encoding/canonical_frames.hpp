// Frames in which a linear system does not change when the scene is rotated or mirrored, or when segments' frames are
// rolled about their axes. (That roll has no physical meaning for a circular section.)
//
// A joint's rows are in its own frame, whose z is along the rod; the roll about z and the handedness are arbitrary.
// With transverse pairs (x, y) as complex numbers, the frame of joint k is rolled by the unit number t_k:
//   along a tree  t_k = t_parent conj(u),  u = -(B_00 + B_11 + i (B_10 - B_01)) / |.|,  B the transverse bend block of
//                 the coupling of k with its parent: frames are carried along the rod without roll
//   as a whole    every tree is rolled so that x is the axis of largest second moment of its transverse vectors v_k,
//                 sqrt(sum (t v_k)^2), pointing to sum t v_k
//   mirrored      across the xz plane if the tree's hand is negative; bend and twist are axial vectors, which a mirror
//                 transforms with the opposite sign
// An Alignment is the source of v_k and of the hand:
//   residual      v_k are the stretch-shear pairs, and the bending pairs turned by 90 degrees (planar motion bends
//                 about the normal); the hand is the sum of twists, or if that is 0, whether sum t v_k is left of x
//   matrix        v_k = (B_35, B_45) of the coupling, the bend of the joint against its parent; the hand is the sense
//                 of rotation of v_k along the tree, sum Im conj(t v_parent) t v_k. Only a straight tree's axis and a
//                 flat tree's hand come from the residual.
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

enum class Alignment { residual, matrix };

class CanonicalFrames {
 public:
  CanonicalFrames(const SystemPattern& pattern, Alignment alignment);

  /// Sets the frames and scales of a system and its residual. Allocates nothing.
  void find(const SystemPattern& pattern, const BlockMatrix& a, const VectorX& residual);

  const CanonicalFrame& frame(int place) const { return frames_[static_cast<std::size_t>(place)]; }
  /// S of a place's joint: d = rho S T^T d^ and A^ = S T A T^T S, as in scaled_system.hpp.
  const Lane8& scale(int place) const { return scales_[static_cast<std::size_t>(place)]; }
  double rho() const { return rho_; }  ///< root mean square of S r

 private:
  struct Pair {
    double x = 0, y = 0;  ///< parts of a complex number
  };
  /// Sums over a tree: of a vector, of its square, of its absolute square, and of the terms that give the hand.
  struct Moments {
    Pair first, second;
    double size = 0, hand = 0;
  };
  struct Tree {
    Moments moments;
    Pair axis;        ///< unit vector that becomes x; zero until it is known
    double hand = 0;  ///< only its sign matters; zero until it is known
  };
  void carry(const SystemPattern& pattern, const BlockMatrix& a, const VectorX& residual);
  void orient_by_matrix(const SystemPattern& pattern, const BlockMatrix& a);
  void orient_by_residual(const SystemPattern& pattern, const VectorX& residual);
  static void set_axis(Tree& tree);

  Alignment alignment_;
  std::vector<int> tree_;  ///< of each place
  std::vector<Tree> trees_;
  std::vector<CanonicalFrame> frames_;
  std::vector<Lane8> scales_;
  std::vector<Pair> roll_;  ///< t
  std::vector<Pair> bent_;  ///< t v of the matrix
  double rho_ = 0;
};

/// scaled_system() in these frames.
ScaledSystem<float> canonical_system(const SystemPattern& pattern, const CanonicalFrames& frames, const BlockMatrix& a,
                                     const VectorX& residual, const VectorX& error, double unit_energy);

}  // namespace rodsweep
