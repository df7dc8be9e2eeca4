// The block matrix and its eight-lane kernels.
#include <catch2/catch.hpp>
#include <cmath>

#include "solver/linear/block_matrix.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_block_matrix {

using test::Random;

TEST_CASE("sum_lanes adds all eight lanes of each vector and leaves the spare lanes zero") {
  Lane8 v[6];
  for (int r = 0; r < 6; ++r)
    for (int lane = 0; lane < 8; ++lane) v[r][lane] = std::ldexp(1, lane) * (r + 1);  // lanes differ
  const Lane8 sum = sum_lanes(v);
  for (int r = 0; r < 6; ++r) CHECK(sum[r] == 255.0 * (r + 1));
  CHECK(sum[6] == 0);
  CHECK(sum[7] == 0);
}

TEST_CASE("load6 and store6 move six doubles and touch nothing else") {
  const double from[8] = {1, 2, 3, 4, 5, 6, 77, 88};
  const Lane8 loaded = load6(from);
  CHECK(loaded[5] == 6);
  CHECK(loaded[6] == 0);
  CHECK(loaded[7] == 0);
  double to[8] = {0, 0, 0, 0, 0, 0, -7, -8};
  store6(to, broadcast(3));
  for (int i = 0; i < 6; ++i) CHECK(to[i] == 3);
  CHECK(to[6] == -7);
  CHECK(to[7] == -8);
}

TEST_CASE("the pattern holds each coupling once, both ways, sorted, and every diagonal") {
  const BlockMatrix a(4, {{3, 1}, {1, 3}, {1, 3}, {0, 1}, {1, 1}});
  CHECK(a.block_rows() == 4);
  CHECK(a.unknowns() == 24);
  CHECK(a.block_count() == 8);  // four diagonal blocks and two couplings with both directions
  for (int row = 0; row < 4; ++row) {
    CHECK(a.column(a.diagonal(row)) == row);
    CHECK(a.find(row, row) == a.diagonal(row));
    for (int k = a.row_begin(row); k < a.row_end(row); ++k) {
      CHECK(a.find(row, a.column(k)) == k);
      CHECK(a.find(a.column(k), row) >= 0);
      if (k > a.row_begin(row)) CHECK(a.column(k - 1) < a.column(k));
    }
  }
  CHECK(a.find(0, 1) >= 0);
  CHECK(a.find(3, 1) >= 0);
  CHECK(a.find(0, 3) == -1);
  CHECK(a.find(2, 3) == -1);
}

TEST_CASE("the block product equals the dense one") {
  for (const int rows : {1, 2, 5, 17}) {
    BlockMatrix a(rows, rows > 4 ? test::ring(rows) : test::chain(rows));
    Random random(static_cast<unsigned>(rows));
    for (Block6& block : a.blocks)  // not symmetric, to detect a transposed block
      for (Lane8& column : block.column) column = load6(random.entries(6).eval().data());
    const VectorX x = random.entries(a.unknowns());
    VectorX y = VectorX::Constant(a.unknowns() + 2, 99);
    a.multiply(x.data(), y.data());
    CHECK((y.head(a.unknowns()) - a.dense() * x).lpNorm<Eigen::Infinity>() < 1e-14);
    CHECK(y.tail(2) == VectorX::Constant(2, 99));
  }
}

TEST_CASE("the energy norm is x^T A x and leaves A x behind") {
  const BlockMatrix a = test::random_matrix(test::chain(5), 5, 3);
  const VectorX x = Random(4).entries(a.unknowns());
  VectorX scratch(a.unknowns());
  CHECK(energy_norm_squared(a, x, scratch) == Approx(x.dot(a.dense() * x)).epsilon(1e-13));
  CHECK((scratch - a.dense() * x).lpNorm<Eigen::Infinity>() < 1e-13);
}

TEST_CASE("what Jacobi makes of a matrix follows from its diagonal") {
  const BlockMatrix a = test::random_matrix(test::tree(2, 3), 13, 1);
  const VectorX diagonal = a.dense().diagonal(), r = test::Random(3).entries(a.unknowns());
  VectorX s(a.unknowns());
  inverse_root_diagonal(a, s);
  CHECK((s - diagonal.cwiseSqrt().cwiseInverse()).norm() < 1e-14 * s.norm());
  CHECK(jacobi_norm_squared(a, r) == Approx(r.cwiseProduct(s).squaredNorm()).epsilon(1e-13));
}

}  // namespace rodsweep::test_block_matrix
