// The few normal equations of a guess that combines stored vectors v_k, G c = g with their Gram matrix G in some inner
// product, in the order of preference. Scaled to a unit diagonal, G = L D L^T is factorised in that order, and a vector
// that the ones before it span already (pivot, the squared share of it that they leave, below `smallest_pivot`) is
// dropped. A whole column at a time, since one entry after the other would cost as much as forming G on a short rod.
// Nothing allocates after construction.
#pragma once

#include <vector>

#include "solver/numbers/lanes.hpp"

namespace rodsweep {

class NormalEquations {
 public:
  /// Below 1e-12 a pivot is rounding error.
  explicit NormalEquations(int most, double smallest_pivot = 1e-12);

  /// The first `count` of them: both triangles of G, and g.
  double& gram(int row, int column) { return entries(gram_, column)[row]; }
  double& right_side(int row) { return entries(coefficients_, 0)[row]; }

  /// `damping` d adds d^2 sum c_k^2 |v_k|^2 to what is minimised (Tikhonov).
  void factorise(int count, double damping = 0);
  /// c in place of g; 0 of what is dropped, and of vectors without length. Of one factorisation as often as wanted.
  void solve();
  double coefficient(int row) const { return reinterpret_cast<const double*>(coefficients_.data())[row]; }

 private:
  Lane8* column(std::vector<Lane8>& of, int index) { return of.data() + static_cast<std::size_t>(index) * width_; }
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
