// Dense matrices as the reference of what the solver does in blocks: Eigen's decompositions, which take seconds to
// compile, in one source for all tests.
#pragma once

#include "solver/numbers/types.hpp"

namespace rodsweep::test {

using MatrixX = Eigen::MatrixXd;

/// Solution of the symmetric positive definite system by Eigen; throws std::runtime_error where A is not.
VectorX dense_solve(const MatrixX& a, const VectorX& b);
MatrixX product(const MatrixX& a, const MatrixX& b);
VectorX least_squares(const MatrixX& a, const VectorX& b);
double determinant(const MatrixX& a);
/// Of a symmetric matrix, ascending.
VectorX eigenvalues(const MatrixX& a);

struct Modes {
  VectorX values;   ///< ascending
  MatrixX vectors;  ///< a column each
};
/// K v = value M v, both symmetric, M positive definite.
Modes modes(const MatrixX& k, const MatrixX& m);

/// Of D^-1/2 A D^-1/2, D the diagonal of A.
double smallest_scaled_eigenvalue(const MatrixX& a);
/// max |A_ij - B_ij| / sqrt(A_ii A_jj).
double scaled_difference(const MatrixX& a, const MatrixX& b);
/// sqrt((x - y)^T A (x - y) / y^T A y).
double energy_error(const MatrixX& a, const VectorX& x, const VectorX& y);

}  // namespace rodsweep::test
