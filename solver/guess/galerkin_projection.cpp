#include "solver/guess/galerkin_projection.hpp"

namespace rodsweep {
namespace {

constexpr double smallest_deflating_pivot = 1e-6;

}  // namespace

GalerkinProjection::GalerkinProjection(int size)
    : order_(Eigen::VectorXi::Zero(size)),
      gram_(size, size),
      start_(VectorX::Zero(size)),
      coefficients_(VectorX::Zero(size)),
      of_residual_(VectorX::Zero(size)),
      equations_(size),
      deflating_equations_(size, smallest_deflating_pivot) {}

void GalerkinProjection::project(const BlockMatrix& a, const VectorX& b, StoredVectors& v, const Eigen::VectorXi& order,
                                 int known, VectorX& x0) {
  v.project(a, b, gram_, start_);
  order_ = order;
  known_ = known;
  equations_.factorise(gram_, order_, known_);
  equations_.solve(order_, start_);
  v.combine(start_, x0);
}

void GalerkinProjection::deflate(const BlockMatrix& a, StoredVectors& v, StoredVectors& products) {
  deflating_equations_.factorise(gram_, order_, known_);
  vectors_ = &v;
  products_ = &products;
  products.multiply(a, v);
}

void GalerkinProjection::reduce(double* r) {
  vectors_->dots(r, of_residual_);
  deflating_equations_.solve(order_, of_residual_);
  products_->subtract(of_residual_, r);
}

void GalerkinProjection::complete(double* z) {
  products_->dots(z, coefficients_);
  deflating_equations_.solve(order_, coefficients_);
  coefficients_ -= of_residual_;
  vectors_->subtract(coefficients_, z);
}

}  // namespace rodsweep
