// Vectors side by side against dense algebra, for every memory layout.
#include <catch2/catch.hpp>

#include "solver/linear/stored_vectors.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_stored_vectors {

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

}  // namespace rodsweep::test_stored_vectors
