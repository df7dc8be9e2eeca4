// Some vectors of unknowns side by side, the same entry of all of them in neighbouring lanes, so that what is asked of
// all of them with A takes one pass over A and over them: V^T A V and V^T b of a Galerkin projection, and V c.
//
// As A is symmetric, V^T A V = G + G^T with G = sum_i V_i^T (A_ii V_i / 2 + sum_{j < i} A_ij V_j): half the blocks.
#pragma once

#include <vector>

#include "solver/linear/block_matrix.hpp"

namespace rodsweep {

class StoredVectors {
 public:
  StoredVectors(int unknowns, int count);  ///< zeros; unknowns a multiple of six

  void set(int index, const VectorX& v);

  /// Sets gram to V^T A V, of which the lower triangle is written, and right_side to V^T b. Sized by the caller: count.
  void project(const BlockMatrix& a, const VectorX& b, Eigen::MatrixXd& gram, VectorX& right_side);

  /// Sets these to A V of others, as many.
  void multiply(const BlockMatrix& a, const StoredVectors& v);

  /// c = V^T x.
  void dots(const double* x, VectorX& c);

  /// x = V c, and x -= V c.
  void combine(const VectorX& c, VectorX& x);
  void subtract(const VectorX& c, double* x);

 private:
  double* row(int unknown) { return entries_.data() + static_cast<std::size_t>(unknown) * width_; }
  const double* row(int unknown) const { return entries_.data() + static_cast<std::size_t>(unknown) * width_; }
  void set_factors(const VectorX& c);
  Lane8 combined(int block_row) const;

  int block_rows_, count_;
  std::size_t width_;            ///< count, rounded up to whole lanes of four
  std::vector<double> entries_;  ///< [unknowns, width]
  std::vector<double> half_;     ///< [width, width] G
  std::vector<double> dots_;     ///< [width] V^T b, or c
};

}  // namespace rodsweep
