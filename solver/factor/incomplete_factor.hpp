// An incomplete factor P = L D L^T of a symmetric positive definite matrix A of 6x6 blocks, to precondition with.
//
// Elimination couples all later neighbours of a block row. The level of fill of a new coupling is one plus the least
// sum of the levels of the two couplings that cause it; couplings up to `levels` are kept (Saad 2003, Iterative Methods
// for Sparse Linear Systems, 10.3.3). At level 0 no new coupling is kept. Without fill-in, as on chains and trees
// eliminated from their leaves, P is A at every level. With loops the order matters: on lattices and nets, a level of
// fill in reverse Cuthill-McKee (breadth_first_order() of elimination_order.hpp) mostly needs a quarter to half of the
// iterations of the joints' own order. Stiff ones may need more.
//
// P may be indefinite although A is positive definite. Then a multiple of A's diagonal is added to A, the least of
// 1e-4, 4e-4, 1.6e-3, ... that gives a definite P (Manteuffel 1980, Math. Comp. 34). Every trial costs a
// set-up, and a large one costs many iterations.
//
// Computed in double and stored in single precision: a solve is bound by reading the factor, and P is an approximation.
// A block is three registers of two rows each, so an application costs about as much as a product with A. Nothing
// allocates after construction.
#pragma once

#include <vector>

#include "solver/linear/block_matrix.hpp"

namespace rodsweep {

class IncompleteFactor {
 public:
  /// `order`: block rows, eliminated from the last to the first.
  IncompleteFactor(const BlockMatrix& pattern, const std::vector<int>& order, int levels);

  /// `a` has the pattern of construction. Returns false if no multiple of the diagonal helps; then it is invalid.
  bool factorise(const BlockMatrix& a);

  /// z = P^-1 r.
  void apply(const double* r, double* z);

  double shift() const { return shift_; }  ///< the multiple of its diagonal that was added to A
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
    int updates;   ///< number of the column's updates A_pq -= B_p^T X_q with this q
  };
  struct Update {
    int p, target;  ///< entries of off_
  };
  bool eliminate(const BlockMatrix& a);
  static void narrow(const Block6& rows, double scale, FloatBlock& out);

  std::vector<Column> columns_;
  std::vector<Off> off_;
  std::vector<Update> updates_;
  std::vector<Block6> diagonal_work_, off_work_;  ///< rows of the remaining A
  std::vector<FloatBlock> inverse_, factor_;      ///< S^-1 of every column, X_p of its neighbours (block_factor.hpp)
  std::vector<TwoRows> solution_;                 ///< forward: two halves to be added; backward: both the same
  double scale_ = 1;                              ///< factor of the stored S^-1, so that it fits a float
  double shift_ = 0;
};

}  // namespace rodsweep
