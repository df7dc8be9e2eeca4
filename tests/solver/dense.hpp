// Dense reference solutions for the solver's block algorithms. One source file compiles Eigen's decompositions for all
// tests, since that takes seconds.
#pragma once

#include "solver/numbers/types.hpp"

namespace rodsweep::test {

using MatrixX = Eigen::MatrixXd;

/// Solves A x = b with A symmetric positive definite; throws std::runtime_error if A is not.
VectorX dense_solve(const MatrixX& a, const VectorX& b);
MatrixX product(const MatrixX& a, const MatrixX& b);
VectorX least_squares(const MatrixX& a, const VectorX& b);
double determinant(const MatrixX& a);
/// Eigenvalues of a symmetric matrix, ascending.
VectorX eigenvalues(const MatrixX& a);

struct Modes {
  VectorX values;   ///< ascending
  MatrixX vectors;  ///< one per column
};
/// Solves K v = value M v with K, M symmetric and M positive definite.
Modes modes(const MatrixX& k, const MatrixX& m);

/// The smallest eigenvalue of D^-1/2 A D^-1/2, where D is the diagonal of A.
double smallest_scaled_eigenvalue(const MatrixX& a);
/// max |A_ij - B_ij| / sqrt(A_ii A_jj).
double scaled_difference(const MatrixX& a, const MatrixX& b);
/// sqrt((x - y)^T A (x - y) / y^T A y).
double energy_error(const MatrixX& a, const VectorX& x, const VectorX& y);

}  // namespace rodsweep::test
