// Direct solution of A x = b by elimination from the leaves of a rod to its root, O(n) on chains and trees.
//
// All leaves are eliminated first, then the leaves of the remaining tree, and so on to the middle. The remaining
// neighbours of an eliminated joint share a segment with it and are already coupled, so there is no fill-in (as in the
// body-and-joint tree of Deul et al. 2018). Consecutive joints of the order are independent: a chain is eliminated from
// both ends at once, and the processor overlaps the two. (Long rods are eliminated one branch after the other, for the
// caches.) If joints close loops (rings, nets, lattices), elimination_plan.hpp finds the order with the least
// fill-in. With little fill-in blocks are eliminated one by one (block_elimination.hpp), else in dense fronts
// (multifrontal_factor.hpp).
#pragma once

#include <variant>
#include <vector>

#include "solver/factor/block_elimination.hpp"
#include "solver/factor/elimination_plan.hpp"
#include "solver/factor/multifrontal_factor.hpp"
#include "solver/linear/solve_outcome.hpp"
#include "solver/rod/rod.hpp"

namespace rodsweep {

/// Joints of the rod from its middle to its leaves; a branch ends at a static segment as at a free end. Joints of
/// loops, and between loops, come first.
std::vector<int> root_to_leaf_order(const Rod& rod);

class BlockFactor {
 public:
  /// `preferred`: block rows, eliminated from the last to the first; replaced by a better order if it has fill-in.
  /// Throws FactorTooLarge before it allocates more memory than allowed.
  BlockFactor(const BlockMatrix& pattern, const std::vector<int>& preferred);
  /// `plan` is that of the pattern.
  BlockFactor(const BlockMatrix& pattern, EliminationPlan plan);

  /// Factorises and solves. `a` has the pattern of construction. x is valid only if the outcome is `converged`.
  SolveOutcome solve(const BlockMatrix& a, const VectorX& b, VectorX& x);

  /// Factorises for substitute(). Returns false if `a` is not positive definite.
  bool factorise(const BlockMatrix& a);

  /// x <- A^-1 x with the matrix of the last factorise(), without another call in between.
  void substitute(VectorX& x);
  /// The same for eight right-hand sides, one per lane: x has six rows per block row.
  void substitute(std::vector<Lane8>& x);

  /// Off-diagonal blocks that are not in the matrix; zero for chains and trees.
  int fill_in() const { return fill_in_; }
  bool has_fronts() const { return std::holds_alternative<MultifrontalFactor>(factor_); }

 private:
  std::variant<BlockElimination, MultifrontalFactor> factor_;
  int fill_in_;
};

}  // namespace rodsweep
