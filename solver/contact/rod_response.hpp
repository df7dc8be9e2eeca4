// The response of a rod to impulses on its segments, to first order: the joints reduce the motions of the free
// segments.
//
//   A dlambda = -J R^T u,   u <- u + R M^-1 J^T dlambda,   A = J M^-1 J^T + alpha~
//
// so that constraints and multipliers stay consistent, J R^T u + alpha~ dlambda = 0; R rotates from the segments'
// frames to the world, in which contacts act. With u = M^-1 f this is H f, where, without R,
// H = M^-1 - M^-1 J^T A^-1 J M^-1, which is at most M^-1: a rod moves no more than its free segments would.
// A response costs O(n) on chains and trees, with the factor of A kept. Nothing allocates after the first assembly.
#pragma once

#include <vector>

#include "solver/factor/direct_factor.hpp"
#include "solver/linear/linear_system.hpp"

namespace rodsweep {

class RodResponse {
 public:
  explicit RodResponse(const Rod& rod);

  /// Assembles at the rod's pose. Multipliers start from zero. Does not check that A is positive definite: the
  /// rod's projection has just solved with nearly the same A. Gauss-Seidel projections have no A. With them, a response
  /// that is not finite appears in the state.
  void assemble(const Rod& rod, double dt);

  /// Whether a segment has turned so far since the assembly that its response is only a rough one.
  bool is_stale(const Rod& rod) const;

  /// M^-1 times a force and a torque about the centre (in that order, in the world) on a segment.
  Lane8 free_motion(const Rod& rod, int segment, const Lane8& wrench) const;

  /// `motion`: dx and dtheta of every segment, lanes 0..2 and 3..5, in the world; zero for static segments.
  void respond(const Rod& rod, Lane8* motion);

  /// Finds H for forces and torques on one segment, for compliance().
  void load(const Rod& rod, int segment);
  /// H for the loaded segment: the motion of another, a column for each component of the force and the torque.
  Block6 compliance(const Rod& rod, int of);

  /// dlambda of all responses since the assembly or forget_multipliers().
  const VectorX& multipliers() const { return multipliers_; }
  void forget_multipliers() { multipliers_.setZero(); }

 private:
  struct Turn {
    Lane8 to_world[3], to_own[3];  ///< columns of R and R^T, for both vectors of a motion
  };

  LinearSystem system_;
  DirectFactor factor_;
  VectorX change_;  ///< J u, then -dlambda
  VectorX multipliers_;
  std::vector<Lane8> own_, taken_back_;       ///< motions in the segments' frames
  std::vector<std::vector<JointEnd>> sides_;  ///< of every segment
  std::vector<Quaternion> orientation_;       ///< at the assembly
  std::vector<Turn> turns_;
  int loaded_ = -1;
  std::vector<Lane8> columns_;  ///< A^-1 J M^-1 R^T of the loaded segment, a column per lane
};

/// The Delassus operator of a rod: H between the segments that contacts touch, in 6x6 blocks. The
/// motion of every touched segment follows from an impulse on one of them without the rest of the rod.
///
/// t touched segments cost 6 t substitutions with the factor and t^2 blocks of 384 bytes, so their number is limited.
/// Allocates only for more touched segments than before.
class DelassusOperator {
 public:
  DelassusOperator(int segments, int most_touched) : most_touched_(at(most_touched)), place_(at(segments), -1) {}

  /// Forgets all segments: the response was assembled anew.
  void clear();

  /// Adds a segment, unless it is there or is one too many.
  void touch(int segment);

  /// Finds the blocks of segments that were added since the last call.
  void update(const Rod& rod, RodResponse& response);

  bool is_full() const { return is_full_; }  ///< a touched segment was one too many: the blocks are of no use

  /// The motion of a touched segment by a force and a torque on another: dx and dtheta in the world.
  const Block6& block(int of, int by) const { return blocks_[place(by) * stride_ + place(of)]; }

 private:
  std::size_t place(int segment) const { return at(place_[at(segment)]); }
  void grow();

  std::size_t most_touched_;
  std::vector<int> place_;  ///< of every segment of the rod among those touched, or -1
  std::vector<int> touched_;
  std::size_t known_ = 0;               ///< touched segments with blocks
  std::size_t stride_ = 0;              ///< blocks in a column
  std::vector<Block6> blocks_, grown_;  ///< columns; room to copy them
  bool is_full_ = false;
};

}  // namespace rodsweep
