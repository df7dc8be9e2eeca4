// Block elimination A = L D L^T from the leaves of a rod to its root: O(n) on chains and trees, which have no fill-in.
// With little fill-in (rings, small nets) every update of one block by another is listed.
//
// Per joint k, with S = L D L^T the remaining diagonal block and B_p the blocks towards the joints p eliminated
// later:
//   W_p = L^-1 B_p,  U_p = D^-1 W_p,  X_p = L^-T U_p,  y = S^-1 b_k,
//   A_pp -= W_p^T U_p,  A_pq -= X_p^T B_q,  b_p -= X_p^T b_k     and backwards   x_k = y - sum_p X_p x_p.
// A factor that is kept consists of S^-1 and the X_p. b is stored in a spare lane of the rows, so the forward
// substitution costs nothing. A pivot in D that is not positive means that A is not positive definite.
#pragma once

#include <vector>

#include "solver/linear/block_matrix.hpp"
#include "solver/linear/solve_outcome.hpp"

namespace rodsweep {

class BlockElimination {
 public:
  /// `order`: block rows, eliminated from the last to the first.
  BlockElimination(const BlockMatrix& pattern, const std::vector<int>& order);

  /// As in BlockFactor.
  SolveOutcome solve(const BlockMatrix& a, const VectorX& b, VectorX& x);
  bool factorise(const BlockMatrix& a);
  void substitute(VectorX& x);
  void substitute(std::vector<Lane8>& x);

 private:
  struct Column {            ///< one elimination, in the order of elimination
    int row;                 ///< block row of A
    int off_begin, off_end;  ///< its later neighbours: entries of off_
    int update_begin;        ///< its pairs of later neighbours: entries of updates_
    int diagonal_source;     ///< block of A
    bool updated;            ///< by earlier eliminations: then it is in diagonal_work_
  };
  struct Off {
    int position;  ///< of the neighbour in the elimination order
    int source;    ///< block of A whose columns are this block's rows; -1 for fill
    bool updated;  ///< by earlier eliminations: then it is in off_work_
    bool first;    ///< whether this is the first update of the neighbour's diagonal block
  };
  struct Update {
    int target;  ///< of A_pq -= B_p^T X_q: entry of off_
    bool first;  ///< whether this is the target's first update
  };
  void list_updates();
  template <bool keep_inverse>
  bool eliminate(const BlockMatrix& a, const double* b);  ///< b null: no right-hand side

  std::vector<Column> columns_;
  std::vector<Off> off_;
  std::vector<Update> updates_;        ///< for every q, its p < q
  std::vector<Block6> diagonal_work_;  ///< rows, lane 6 the right-hand side
  std::vector<Block6> off_work_;       ///< rows of B_p before, of X_p after its elimination
  std::vector<Block6> inverse_;        ///< rows of S^-1, of factorise()
  std::vector<Lane8> solution_;        ///< y, then x; lane 6 is -1 for the back substitution
};

}  // namespace rodsweep
