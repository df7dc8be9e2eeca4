#include "tests/solver/dense.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>
#include <stdexcept>

namespace rodsweep::test {

VectorX dense_solve(const MatrixX& a, const VectorX& b) {
  const Eigen::LLT<MatrixX> factor(a);
  if (factor.info() != Eigen::Success) throw std::runtime_error("the reference matrix is not positive definite");
  return factor.solve(b);
}

MatrixX product(const MatrixX& a, const MatrixX& b) { return a * b; }

VectorX least_squares(const MatrixX& a, const VectorX& b) { return a.colPivHouseholderQr().solve(b); }

double determinant(const MatrixX& a) { return Eigen::FullPivLU<MatrixX>(a).determinant(); }

VectorX eigenvalues(const MatrixX& a) {
  return Eigen::SelfAdjointEigenSolver<MatrixX>(a, Eigen::EigenvaluesOnly).eigenvalues();
}

Modes modes(const MatrixX& k, const MatrixX& m) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixX> eigen(k, m);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

double smallest_scaled_eigenvalue(const MatrixX& a) {
  const VectorX scale = a.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixX scaled = scale.asDiagonal() * a * scale.asDiagonal();
  return eigenvalues(scaled).minCoeff();
}

double scaled_difference(const MatrixX& a, const MatrixX& b) {
  const VectorX scale = a.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

double energy_error(const MatrixX& a, const VectorX& x, const VectorX& y) {
  return std::sqrt((x - y).dot(a * (x - y)) / y.dot(a * y));
}

}  // namespace rodsweep::test
