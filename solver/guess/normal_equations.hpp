// The few normal equations of a guess that combines stored vectors v_k, G c = g with their Gram matrix G in some inner
// product, in the order of preference. Scaled to a unit diagonal, G = L D L^T is factorised in that order, and a vector
// that the ones before it span already (pivot, the squared share of it that they leave, below 1e-12) is dropped.
// Nothing allocates after construction.
#pragma once

#include "solver/numbers/types.hpp"

namespace rodsweep {

class NormalEquations {
 public:
  explicit NormalEquations(int most);

  /// The first `count` of them: lower triangle of G, and g.
  double& gram(int row, int column) { return gram_(row, column); }
  double& right_side(int row) { return coefficients_[row]; }

  /// `damping` d adds d^2 sum c_k^2 |v_k|^2 to what is minimised (Tikhonov).
  void factorise(int count, double damping = 0);
  /// c in place of g; 0 of what is dropped, and of vectors without length. Of one factorisation as often as wanted.
  void solve();
  double coefficient(int row) const { return coefficients_[row]; }

 private:
  int count_ = 0;
  Eigen::MatrixXd gram_;  ///< then L below the diagonal
  VectorX pivot_, scale_, coefficients_;
};

}  // namespace rodsweep
