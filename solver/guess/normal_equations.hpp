// The normal equations G c = g of a guess that combines a few stored vectors v_k in order of preference. G is their
// Gram matrix in some inner product. Scaled to a unit diagonal, G = L D L^T is factorised in that order. A vector
// that those before it nearly span is dropped: its pivot, the squared share of it outside their span, is below
// `smallest_pivot`. Kernels process a whole column at a time: entry by entry would cost as much as forming G on a short
// rod. Nothing allocates after construction.
#pragma once

#include <vector>

#include "solver/numbers/lanes.hpp"

namespace rodsweep {

class NormalEquations {
 public:
  /// Below 1e-12 a pivot is rounding error.
  explicit NormalEquations(int most, double smallest_pivot = 1e-12);

  /// Entries of G and g for the first `count` vectors; set both triangles of G.
  double& gram(int row, int column) { return entries(gram_, column)[row]; }
  double& right_side(int row) { return entries(coefficients_, 0)[row]; }

  /// `damping` d adds d^2 sum c_k^2 |v_k|^2 to the minimised function (Tikhonov).
  void factorise(int count, double damping = 0);
  /// Replaces g by c, which is 0 for dropped vectors and vectors of length zero. One factorisation allows many solves.
  void solve();
  /// The same for the first `count` of `order` among the rows of a larger Gram matrix, and of c, which is 0 in others.
  void factorise(const Eigen::MatrixXd& gram, const Eigen::VectorXi& order, int count, double damping = 0);
  void solve(const Eigen::VectorXi& order, VectorX& c);
  double coefficient(int row) const { return reinterpret_cast<const double*>(coefficients_.data())[row]; }

 private:
  Lane8* column(std::vector<Lane8>& of, int index) { return of.data() + at(index) * width_; }
  double* entries(std::vector<Lane8>& of, int index) { return reinterpret_cast<double*>(column(of, index)); }

  std::size_t width_;  ///< lanes of a column
  double smallest_pivot_;
  int count_ = 0;
  std::vector<Lane8> gram_;   ///< [column, width]; then D L^T on and above the diagonal
  std::vector<Lane8> lower_;  ///< [column, width] L below the diagonal, zeros elsewhere
  std::vector<Lane8> scale_, coefficients_;
  std::vector<double> inverse_pivot_;  ///< 0: dropped
};

}  // namespace rodsweep
