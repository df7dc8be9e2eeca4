// Direct solution of A x = b by elimination from the leaves of a rod to its root, O(n) on chains and trees.
//
// All leaves come first, then what they leave as leaves, and so on to the middle: the remaining neighbours of an
// eliminated joint share a segment with it and are coupled already, so no block fills in (as in the body-and-joint tree
// of Deul et al. 2018), and joints that follow each other don't wait for each other: a chain is eliminated from both
// ends at once, and the processor overlaps the two (long rods one branch after the other, as memory likes it). Where
// joints close loops (rings, nets, lattices), elimination_plan.hpp finds the order that fills in least: with little
// fill the blocks are eliminated one by one (block_elimination.hpp), with more in dense fronts
// (multifrontal_factor.hpp).
#pragma once

#include <variant>
#include <vector>

#include "solver/linear/block_elimination.hpp"
#include "solver/linear/elimination_plan.hpp"
#include "solver/linear/multifrontal_factor.hpp"
#include "solver/linear/solve_outcome.hpp"
#include "solver/rod/rod.hpp"

namespace rodsweep {

/// Joints of the rod from its middle to its leaves; what hangs on a static segment ends there as on a free one. Joints
/// of loops, and between them, come first.
std::vector<int> root_to_leaf_order(const Rod& rod);

class BlockFactor {
 public:
  /// `preferred`: block rows, eliminated from the last to the first; an order that fills in gives way to a better one.
  /// Throws FactorTooLarge before it asks for more memory than a factor may have.
  BlockFactor(const BlockMatrix& pattern, const std::vector<int>& preferred);

  /// Factorises and solves. `a` has the pattern of construction. On anything but `converged`, x is not to be used.
  SolveOutcome solve(const BlockMatrix& a, const VectorX& b, VectorX& x);

  /// Factorises for substitute(). Returns false where `a` is not positive definite.
  bool factorise(const BlockMatrix& a);

  /// x <- A^-1 x with the matrix of the last factorise(), no other call between.
  void substitute(VectorX& x);

  /// Off-diagonal blocks that are not in the matrix; zero for chains and trees.
  int fill_in() const { return fill_in_; }
  bool has_fronts() const { return std::holds_alternative<MultifrontalFactor>(factor_); }

 private:
  BlockFactor(const BlockMatrix& pattern, EliminationPlan plan);

  std::variant<BlockElimination, MultifrontalFactor> factor_;
  int fill_in_;
};

}  // namespace rodsweep
