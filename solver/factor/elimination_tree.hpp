// The cost of an elimination before it is stored: the elimination tree and the number of blocks of every column of L,
// in time nearly linear in the blocks of A and independent of the fill-in.
//
// The parent of a column is its first later neighbour, fill-in included (Liu 1990). Counts are those of Gilbert, Ng &
// Peyton 1994: leaves of the row subtrees minus their common ancestors. Columns are numbered in a postorder; a
// postorder of an elimination order has the same fill-in.
#pragma once

#include <cstdint>
#include <vector>

#include "solver/linear/block_matrix.hpp"

namespace rodsweep {

struct EliminationTree {
  std::vector<int> row;     ///< block row of A that is eliminated k-th
  std::vector<int> parent;  ///< -1 for a root
  std::vector<int> count;   ///< blocks of a column of L, the diagonal one included

  int columns() const { return static_cast<int>(row.size()); }
  std::int64_t blocks() const;  ///< of L
  double flops() const;         ///< of a factorisation, to leading order
};

/// The tree of an elimination from the last to the first row of `order`.
EliminationTree elimination_tree(const BlockMatrix& pattern, const std::vector<int>& order);

/// Children before parents, each subtree contiguous; siblings in the order of their numbers.
std::vector<int> postorder(const std::vector<int>& parent);

}  // namespace rodsweep
