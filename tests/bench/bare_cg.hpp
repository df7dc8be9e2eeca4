// Reference for the cost of CG: Jacobi-preconditioned conjugate gradients as one plain Eigen loop. The arithmetic is
// that of KSPCG with the true-residual norm.
#pragma once

#include "solver/linear/block_matrix.hpp"

namespace rodsweep {

class BareCg {
 public:
  explicit BareCg(const BlockMatrix& a);
  /// Runs `iterations` iterations from zero; returns the norm of the last residual.
  double run(const VectorX& b, VectorX& x, int iterations);

 private:
  const BlockMatrix& a_;
  VectorX inverse_diagonal_, r_, z_, p_, w_;
};

}  // namespace rodsweep
