// The small normal equations of guesses against dense algebra.
#include <limits>

#include "solver/guess/normal_equations.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_normal_equations {

using test::MatrixX;

MatrixX gram_of(const MatrixX& v) { return v.transpose() * v; }

VectorX solved(NormalEquations& equations, const VectorX& right_side) {
  const int count = static_cast<int>(right_side.size());
  for (int i = 0; i < count; ++i) equations.right_side(i) = right_side[i];
  equations.solve();
  VectorX c(count);
  for (int i = 0; i < count; ++i) c[i] = equations.coefficient(i);
  return c;
}

void fill(NormalEquations& equations, const MatrixX& gram) {
  for (int i = 0; i < gram.rows(); ++i)
    for (int k = 0; k < gram.cols(); ++k) equations.gram(i, k) = gram(i, k);
}

MatrixX vectors(int count, unsigned seed) {
  test::Random random(seed);
  MatrixX v(40, count);
  for (int k = 0; k < count; ++k) v.col(k) = std::pow(10., k % 5) * random.entries(40);
  return v;
}

TEST_CASE("normal equations have the dense solution, damped or not, with every right-hand side") {
  for (const int most : {1, 7, 8, 9, 20})
    for (int count = 1; count <= most; count += 3) {
      INFO(count << " of " << most);
      NormalEquations equations(most);
      for (const double damping : {0., 0.3}) {
        const MatrixX gram = gram_of(vectors(count, static_cast<unsigned>(most + count)));
        MatrixX damped = gram;
        damped.diagonal() *= 1 + damping * damping;
        fill(equations, gram);
        equations.factorise(count, damping);
        for (const unsigned seed : {1U, 2U}) {
          const VectorX g = gram * test::Random(seed).entries(count);
          const VectorX expected = test::dense_solve(damped, g);
          CHECK((solved(equations, g) - expected).norm() < 1e-9 * expected.norm());
        }
      }
    }
}

TEST_CASE("a vector that the preferred ones span is dropped, and the rest solved without it") {
  MatrixX v = vectors(10, 4);
  v.col(3) = 2 * v.col(0) - v.col(2);
  v.col(9).setZero();
  MatrixX rest(40, 8);
  rest << v.leftCols(3), v.middleCols(4, 5);
  NormalEquations equations(10);
  fill(equations, gram_of(v));
  equations.factorise(10);
  const VectorX b = test::Random(5).entries(40);
  const VectorX c = solved(equations, v.transpose() * b);
  const VectorX expected = test::dense_solve(gram_of(rest), rest.transpose() * b);
  CHECK(c[3] == 0);
  CHECK(c[9] == 0);
  CHECK((c.head(3) - expected.head(3)).norm() < 1e-9 * expected.norm());
  CHECK((c.segment(4, 5) - expected.tail(5)).norm() < 1e-9 * expected.norm());
}

TEST_CASE("a vector whose products are not numbers is dropped alone") {
  const MatrixX v = vectors(9, 8);
  MatrixX gram = gram_of(v);
  gram.row(2).setConstant(std::numeric_limits<double>::quiet_NaN());
  gram.col(2) = gram.row(2).transpose();
  NormalEquations equations(9);
  fill(equations, gram);
  equations.factorise(9);
  const VectorX c = solved(equations, v.transpose() * v.col(5));
  VectorX expected = VectorX::Unit(9, 5);
  CHECK((c - expected).norm() < 1e-9);
}

}  // namespace rodsweep::test_normal_equations
