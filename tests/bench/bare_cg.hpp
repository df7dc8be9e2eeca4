// The yardstick of CG's cost: Jacobi-preconditioned conjugate gradients as one plain Eigen loop, the same arithmetic as
// KSPCG with the true-residual norm, and nothing else.
#pragma once

#include "solver/linear/block_matrix.hpp"

namespace rodsweep {

class BareCg {
 public:
  explicit BareCg(const BlockMatrix& a);
  /// `iterations` steps from zero; returns the last residual's norm.
  double run(const VectorX& b, VectorX& x, int iterations);

 private:
  const BlockMatrix& a_;
  VectorX inverse_diagonal_, r_, z_, p_, w_;
};

}  // namespace rodsweep
