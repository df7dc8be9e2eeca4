// The block matrix, and vectors stored side by side for products with it, against dense algebra.

#include "solver/linear/block_matrix.hpp"
#include "solver/linear/stored_vectors.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_block_matrix {

using test::Random;

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

using test::MatrixX;

TEST_CASE("vectors side by side project and combine as dense algebra does, also after one is replaced") {
  const BlockMatrix a = test::random_matrix(test::tree(2, 3), 13, 1);
  const VectorX b = test::Random(2).entries(a.unknowns());
  for (const int count : {1, 3, 4, 5, 8, 9, 10, 11, 12, 13, 19, 20}) {
    INFO(count);
    test::Random random(static_cast<unsigned>(count));
    StoredVectors stored(a.unknowns(), count);
    MatrixX v(a.unknowns(), count);
    for (int k = 0; k < count + 1; ++k) {
      const int at = k % count;
      v.col(at) = random.entries(a.unknowns());
      stored.set(at, v.col(at));
    }
    MatrixX gram = MatrixX::Zero(count, count);
    VectorX right_side(count), x(a.unknowns());
    for (int again = 0; again < 2; ++again) stored.project(a, b, gram, right_side);
    const MatrixX expected = v.transpose() * a.dense() * v;
    CHECK((gram - expected).norm() < 1e-13 * expected.norm());
    CHECK((right_side - v.transpose() * b).norm() < 1e-13 * v.norm() * b.norm());
    const VectorX c = random.entries(count);
    stored.combine(c, x);
    CHECK((x - v * c).norm() < 1e-14 * v.norm() * c.norm());
    stored.subtract(2 * c, x.data());
    CHECK((x + v * c).norm() < 1e-14 * v.norm() * c.norm());

    StoredVectors products(a.unknowns(), count);
    products.multiply(a, stored);
    VectorX dots(count);
    products.dots(x.data(), dots);
    CHECK((dots - v.transpose() * (a.dense() * x)).norm() < 1e-13 * v.norm() * x.norm() * a.dense().norm());
  }
}

}  // namespace rodsweep::test_block_matrix
