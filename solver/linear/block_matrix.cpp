#include "solver/linear/block_matrix.hpp"

#include <algorithm>
#include <cmath>

namespace rodsweep {

BlockMatrix::BlockMatrix(int block_rows, const std::vector<std::pair<int, int>>& couplings) {
  std::vector<std::vector<int>> rows(at(block_rows));
  for (int i = 0; i < block_rows; ++i) rows[at(i)].push_back(i);
  for (const auto& [i, j] : couplings) {
    rows[at(i)].push_back(j);
    rows[at(j)].push_back(i);
  }
  for (int i = 0; i < block_rows; ++i) {
    std::vector<int>& row = rows[at(i)];
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    const auto own = std::lower_bound(row.begin(), row.end(), i);
    diagonal_.push_back(static_cast<int>(columns_.size() + static_cast<std::size_t>(own - row.begin())));
    columns_.insert(columns_.end(), row.begin(), row.end());
    row_start_.push_back(static_cast<int>(columns_.size()));
  }
  blocks.assign(columns_.size(), Block6{});
}

int BlockMatrix::find(int row, int column) const {
  const auto begin = columns_.begin() + row_begin(row), end = columns_.begin() + row_end(row);
  const auto at = std::lower_bound(begin, end, column);
  return at != end && *at == column ? static_cast<int>(at - columns_.begin()) : -1;
}

void BlockMatrix::multiply(const double* x, double* y) const {
  const int rows = block_rows();
  for (int i = 0; i < rows; ++i) {
    Lane8 even{}, odd{};
    for (int k = row_begin(i); k < row_end(i); ++k) {
      const Block6& block = blocks[at(k)];
      const double* xj = x + 6 * column(k);
      even += block.column[0] * xj[0];
      odd += block.column[1] * xj[1];
      even += block.column[2] * xj[2];
      odd += block.column[3] * xj[3];
      even += block.column[4] * xj[4];
      odd += block.column[5] * xj[5];
    }
    store6(y + 6 * i, even + odd);
  }
}

Eigen::MatrixXd BlockMatrix::dense() const {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(unknowns(), unknowns());
  for (int i = 0; i < block_rows(); ++i)
    for (int k = row_begin(i); k < row_end(i); ++k)
      for (int c = 0; c < 6; ++c)
        for (int r = 0; r < 6; ++r) out(6 * i + r, 6 * column(k) + c) = blocks[at(k)].column[c][r];
  return out;
}

void inverse_root_diagonal(const BlockMatrix& a, VectorX& s) {
  for (int i = 0; i < a.block_rows(); ++i)
    for (int r = 0; r < 6; ++r) s[6 * i + r] = 1 / std::sqrt(a.diagonal_entry(i, r));
}

double jacobi_norm_squared(const BlockMatrix& a, const VectorX& r) {
  double sum = 0;
  for (int i = 0; i < a.block_rows(); ++i)
    for (int k = 0; k < 6; ++k) sum += r[6 * i + k] * r[6 * i + k] / a.diagonal_entry(i, k);
  return sum;
}

double energy_norm_squared(const BlockMatrix& a, const VectorX& x, VectorX& scratch) {
  a.multiply(x.data(), scratch.data());
  return x.dot(scratch);
}

double largest_diagonal_entry(const BlockMatrix& a) {
  double largest = 0;
  for (int block_row = 0; block_row < a.block_rows(); ++block_row)
    for (int row = 0; row < 6; ++row) largest = std::max(largest, a.diagonal_entry(block_row, row));
  return largest;
}

}  // namespace rodsweep
