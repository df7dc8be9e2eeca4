// Direct solution of A x = b by block elimination from the leaves of a rod to its root, O(n) on chains and trees.
//
// Joints are eliminated in the reverse of a depth-first order that starts at the held segments, so that the remaining
// neighbours of an eliminated joint (its parent and its siblings) are coupled already: no block fills in, as in the
// body-and-joint tree of Deul et al. 2018. Where joints close loops (rings, nets) a symbolic elimination finds what
// fills in, in an order of minimum degree (elimination_order.hpp): a sparse Cholesky factorisation in blocks.
//
// Per joint k, with S the block left on the diagonal and B_p the blocks towards the joints p eliminated later:
//   X_p = S^-1 B_p,  y = S^-1 b_k,  A_pq -= B_p^T X_q,  b_p -= B_p^T y      and backwards   x_k = y - sum_p X_p x_p.
// A factor that is kept needs S^-1 and the X_p alone: b_p -= X_p^T b_k, y = S^-1 b_k.
// S is inverted by Gauss-Jordan steps on whole rows; b rides along in a spare lane of the rows, so the forward
// substitution costs nothing. Pivots are those of LDL^T: one that is not positive means that A is not positive
// definite.
#pragma once

#include <vector>

#include "solver/linear/block_matrix.hpp"
#include "solver/linear/solve_outcome.hpp"
#include "solver/rod/rod.hpp"

namespace rodsweep {

/// Joints of the rod in depth-first order, branch by branch, from the static segments (then from segment 0 of what they
/// don't reach).
std::vector<int> root_to_leaf_order(const Rod& rod);

class BlockFactor {
 public:
  /// `preferred`: block rows, eliminated from the last to the first; an order that fills in gives way to minimum
  /// degree.
  BlockFactor(const BlockMatrix& pattern, const std::vector<int>& preferred);

  /// Factorises and solves. `a` has the pattern of construction. On anything but `converged`, x is not to be used.
  SolveOutcome solve(const BlockMatrix& a, const VectorX& b, VectorX& x);

  /// Factorises for substitute(). Returns false where `a` is not positive definite.
  bool factorise(const BlockMatrix& a);

  /// x <- A^-1 x with the matrix of the last factorise(), no other call between.
  void substitute(VectorX& x);

  /// Off-diagonal blocks that are not in the matrix; zero for chains and trees.
  int fill_in() const { return fill_in_; }

 private:
  struct Column {            ///< one elimination, in the order of elimination
    int row;                 ///< block row of A
    int off_begin, off_end;  ///< its later neighbours: entries of off_
    int update_begin;        ///< its pairs of later neighbours: entries of updates_
    int diagonal_source;     ///< block of A
  };
  struct Off {
    int position;  ///< of the neighbour in the elimination order
    int source;    ///< block of A whose columns are this block's rows; -1 for fill
  };
  void load(const BlockMatrix& a, const double* b);  ///< null: none
  template <bool keep_inverse>
  bool eliminate();

  std::vector<Column> columns_;
  std::vector<Off> off_;
  std::vector<int> updates_;           ///< target of A_pq -= B_p^T X_q: entry of off_; for every q, its p < q
  std::vector<Block6> diagonal_work_;  ///< rows, lane 6 the right-hand side
  std::vector<Block6> off_work_;       ///< rows of B_p before, of X_p after its elimination
  std::vector<Block6> inverse_;        ///< rows of S^-1, of factorise()
  std::vector<Lane8> solution_;        ///< y, then x; lane 6 is -1 for the back substitution
  int fill_in_ = 0;
};

}  // namespace rodsweep
