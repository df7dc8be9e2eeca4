// Vectors of unknowns stored side by side, the same entry of eight vectors in neighbouring lanes (a panel). V^T A V and
// V^T b of a Galerkin projection, and V c, then take one pass over A and over the vectors. Up to three vectors beyond
// whole panels are stored singly, the six entries of a block row in one number of eight lanes: another panel would cost
// as much as eight vectors.
//
// As A is symmetric, V^T A V = G + G^T with G = V^T H, H = (D / 2 + L) V, D the diagonal of A and L its part below the
// diagonal: half the blocks, and half the entries of the diagonal ones. A pass forms H and G of one panel in registers,
// and its products with all other panels: 57 + 48 multiply-adds of eight lanes per block row, 25 more per single
// vector.
#pragma once

#include <vector>

#include "solver/linear/block_matrix.hpp"

namespace rodsweep {

class StoredVectors {
 public:
  StoredVectors(int unknowns, int count);  ///< zeros; unknowns a multiple of six

  void set(int index, const VectorX& v);

  /// Sets gram to V^T A V and right_side to V^T b. The caller sizes them for `count`.
  void project(const BlockMatrix& a, const VectorX& b, Eigen::MatrixXd& gram, VectorX& right_side);

  /// Sets these vectors to A V of as many others.
  void multiply(const BlockMatrix& a, const StoredVectors& v);

  /// c = V^T x.
  void dots(const double* x, VectorX& c);

  /// x = V c, and x -= V c.
  void combine(const VectorX& c, VectorX& x);
  void subtract(const VectorX& c, double* x);

 private:
  const Lane8* panel(int index) const { return entries_.data() + at(index) * unknowns_; }
  Lane8* panel(int index) { return entries_.data() + at(index) * unknowns_; }
  const Lane8* single(int index) const { return singles_.data() + at(index) * unknowns_ / 6; }
  Lane8* single(int index) { return singles_.data() + at(index) * unknowns_ / 6; }

  /// Sets the rows of half_ and dots_ of one panel or a part of it, and of all single vectors.
  template <int singles>
  void pass(const BlockMatrix& a, const VectorX& b, int panel, int part);
  /// Calls take(block row, its six entries of V c).
  template <class Take>
  void combined(const VectorX& c, Take take);

  std::size_t unknowns_;
  int count_, panel_count_, single_count_;
  std::vector<Lane8> entries_;     ///< [panel, unknown]
  std::vector<Lane8> singles_;     ///< [single, block row]
  std::vector<Lane8> half_;        ///< [vector, panel] G; for single vectors all of V^T A V
  Eigen::Matrix3d among_singles_;  ///< lower triangle of V^T A V
  std::vector<Lane8> dots_;        ///< [vector in lanes] V^T b, or c
};

}  // namespace rodsweep
