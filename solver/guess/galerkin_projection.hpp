// The best approximation of the solution of A x = b, in the energy norm, in the span of stored vectors V:
//   x0 = V E^-1 V^T b,   E = V^T A V.
// A changes from solve to solve, so A V is formed again: as many products with A as there are vectors, all in one pass
// (stored_vectors.hpp). A vector that those before it nearly span is dropped (normal_equations.hpp).
//
// CG can also project the same span out of every residual r (Deflation of cg_solver.hpp),
//   c = E^-1 V^T r,  r <- r - A V c;   z <- z - V (E^-1 (A V)^T z - c):
// Then search directions are A-orthogonal to V. This drops vectors that others nearly span (pivot below 1e-6), which the
// guess itself uses. An iteration costs four more passes over V.
#pragma once

#include "solver/cg/cg_solver.hpp"
#include "solver/guess/normal_equations.hpp"
#include "solver/linear/stored_vectors.hpp"

namespace rodsweep {

class GalerkinProjection : public Deflation {
 public:
  explicit GalerkinProjection(int size);  ///< vectors at most

  /// Sets x0. `order` lists the first `known` vectors to use, those to keep first.
  void project(const BlockMatrix& a, const VectorX& b, StoredVectors& v, const Eigen::VectorXi& order, int known,
               VectorX& x0);
  /// Projects the same vectors out from now on; they and `products`, of as many, must stay.
  void deflate(const BlockMatrix& a, StoredVectors& v, StoredVectors& products);
  /// r -= A V c of the c of the last x0, with its products.
  void subtract_product(VectorX& r) { products_->subtract(start_, r.data()); }

  void reduce(double* r) override;
  void complete(double* z) override;

 private:
  Eigen::VectorXi order_;
  int known_ = 0;
  Eigen::MatrixXd gram_;  ///< E
  VectorX start_;         ///< V^T b, then c of x0
  VectorX coefficients_;  ///< c of z
  VectorX of_residual_;   ///< V^T r, then E^-1 of it
  NormalEquations equations_, deflating_equations_;
  StoredVectors* vectors_ = nullptr;   ///< that are projected out
  StoredVectors* products_ = nullptr;  ///< A V
};

}  // namespace rodsweep
