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

#include "solver/factor/block_factor.hpp"
#include "solver/linear/linear_system.hpp"

namespace rodsweep {

class RodResponse {
 public:
  explicit RodResponse(const Rod& rod);

  /// Assembles at the rod's positions. Multipliers start from zero. Does not check that A is positive definite: the
  /// rod's projection has just solved with nearly the same A. Gauss-Seidel projections have no A. With them, a response
  /// that is not finite appears in the state.
  void assemble(const Rod& rod, double dt);

  /// `motion`: dx and dtheta of every segment, lanes 0..2 and 3..5, in the world; zero for static segments.
  void respond(const Rod& rod, Lane8* motion);

  /// dlambda of all responses since the assembly.
  const VectorX& multipliers() const { return multipliers_; }

 private:
  LinearSystem system_;
  BlockFactor factor_;
  VectorX change_;  ///< J u, then -dlambda
  VectorX multipliers_;
  std::vector<Lane8> own_, taken_back_;  ///< motions in the segments' frames
};

}  // namespace rodsweep
