// An incomplete factor P = L D L^T of a symmetric positive definite matrix A of 6x6 blocks, to precondition with.
//
// Elimination couples all later neighbours of a block row; a coupling that A lacks is kept where its level of fill, the
// least sum of the levels of the two couplings that make it and one, is at most `levels` (Saad 2003, Iterative Methods
// for Sparse Linear Systems, 10.3.3). At level 0 none is kept; where elimination couples nothing anew, as on chains and
// trees from their leaves on, P is A at every level. Where joints close loops the order decides: in reverse
// Cuthill-McKee (breadth_first_order() of elimination_order.hpp) a level of fill mostly leaves a quarter to half of the
// iterations that it leaves in the joints' own order (lattices and nets; on stiff ones it may leave more).
//
// P need not be positive definite though A is. Then A's diagonal is raised by a share of itself, the least of 1e-4,
// 4e-4, 1.6e-3, ... that helps (Manteuffel 1980, Math. Comp. 34); a set-up costs as many attempts, and a stiff system
// many iterations.
//
// Factorised in double and kept in single precision: both halves of a solve read the factor from memory, and P is an
// approximation anyway. A block is three registers of two rows each, so an application costs about a product with A.
// Nothing allocates after construction.
#pragma once

#include <vector>

#include "solver/linear/block_matrix.hpp"

namespace rodsweep {

class IncompleteFactor {
 public:
  /// `order`: block rows, eliminated from the last to the first.
  IncompleteFactor(const BlockMatrix& pattern, const std::vector<int>& order, int levels);

  /// `a` has the pattern of construction. False where no share of the diagonal helps; it is not to be used then.
  bool factorise(const BlockMatrix& a);

  /// z = P^-1 r.
  void apply(const double* r, double* z);

  double shift() const { return shift_; }  ///< the share of its diagonal that was added to A
  int off_diagonal_blocks() const { return static_cast<int>(off_.size()); }

 private:
  /// Two rows of a block, each with two spare lanes.
  using TwoRows = float __attribute__((vector_size(64)));
  struct FloatBlock {
    TwoRows rows[3];
  };
  struct Column {            ///< one elimination, in the order of elimination
    int row;                 ///< block row of A
    int off_begin, off_end;  ///< its later neighbours: entries of off_
    int update_begin;        ///< the couplings that it changes: entries of updates_
  };
  struct Off {
    int position;  ///< of the neighbour in the elimination order
    int source;    ///< block of A whose columns are this block's rows; -1 for fill
    int updates;   ///< how many of the column's updates are A_pq -= B_p^T X_q with this q
  };
  struct Update {
    int p, target;  ///< entries of off_
  };
  bool eliminate(const BlockMatrix& a);
  static void narrow(const Block6& rows, double scale, FloatBlock& out);

  std::vector<Column> columns_;
  std::vector<Off> off_;
  std::vector<Update> updates_;
  std::vector<Block6> diagonal_work_, off_work_;  ///< rows of what is left of A
  std::vector<FloatBlock> inverse_, factor_;      ///< S^-1 of every column, X_p of its neighbours (block_factor.hpp)
  std::vector<TwoRows> solution_;                 ///< forward in two halves to be added, backward twice the same
  double scale_ = 1;                              ///< S^-1 is kept this many times too large: floats end at 1e38
  double shift_ = 0;
};

}  // namespace rodsweep
