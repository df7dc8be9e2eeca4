// A symmetric matrix of 6x6 blocks in compressed block rows: a block row and column per joint.
//
// Both triangles are stored: a product reads each block once, in order, without a transposed kernel.
#pragma once

#include <utility>
#include <vector>

#include "solver/numbers/lanes.hpp"

namespace rodsweep {

class BlockMatrix {
 public:
  BlockMatrix() = default;
  /// The pattern: `couplings` are pairs of block rows, in any order, possibly repeated; diagonals are always present.
  BlockMatrix(int block_rows, const std::vector<std::pair<int, int>>& couplings);

  int block_rows() const { return static_cast<int>(diagonal_.size()); }
  int unknowns() const { return 6 * block_rows(); }
  int block_count() const { return static_cast<int>(blocks.size()); }

  int row_begin(int row) const { return row_start_[at(row)]; }
  int row_end(int row) const { return row_start_[at(row) + 1]; }
  int column(int block) const { return columns_[at(block)]; }
  const int* row_starts() const { return row_start_.data(); }  ///< first block of each row, and the end
  const int* columns() const { return columns_.data(); }       ///< of each block
  int diagonal(int row) const { return diagonal_[at(row)]; }
  int find(int row, int column) const;  ///< index of the block; -1: not in the pattern

  /// y = A x. `x` and `y` hold unknowns() doubles and don't overlap.
  void multiply(const double* x, double* y) const;

  double diagonal_entry(int block_row, int row) const { return blocks[at(diagonal(block_row))].column[row][row]; }
  Eigen::MatrixXd dense() const;

  std::vector<Block6> blocks;  ///< columns of each block, in row order

 private:
  std::vector<int> row_start_{0}, columns_, diagonal_;
};

/// s = D^-1/2, D the diagonal of A: the scaling of Jacobi. The caller sizes s.
void inverse_root_diagonal(const BlockMatrix& a, VectorX& s);

double largest_diagonal_entry(const BlockMatrix& a);

/// r^T D^-1 r.
double jacobi_norm_squared(const BlockMatrix& a, const VectorX& r);

/// x^T A x; `scratch` holds A x afterwards.
double energy_norm_squared(const BlockMatrix& a, const VectorX& x, VectorX& scratch);

}  // namespace rodsweep
