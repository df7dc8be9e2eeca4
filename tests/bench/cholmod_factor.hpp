// The supernodal Cholesky factorisation of CHOLMOD (Chen, Davis, Hager & Rajamanickam 2008) on one thread, for
// comparison with ours. It gets A without its blocks: a lower triangle of numbers. It orders by minimum degree, or by
// METIS if that has less fill. Its speed is that of its BLAS.
#pragma once

#include <memory>
#include <vector>

#include "solver/linear/block_matrix.hpp"

namespace rodsweep::bench {

class CholmodFactor {
 public:
  /// Orders and plans.
  explicit CholmodFactor(const BlockMatrix& pattern);
  ~CholmodFactor();
  CholmodFactor(const CholmodFactor&) = delete;
  CholmodFactor& operator=(const CholmodFactor&) = delete;

  /// Factorises and solves. Returns false if `a` is not positive definite.
  bool solve(const BlockMatrix& a, const VectorX& b, VectorX& x);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rodsweep::bench
