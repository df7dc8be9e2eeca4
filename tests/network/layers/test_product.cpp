// The product of narrow layers against Eigen's, for all tile shapes; backward passes against central differences.

#include "network/layers/mlp.hpp"
#include "network/layers/narrow_product.hpp"
#include "network/layers/product.hpp"
#include "tests/catch.hpp"
#include "tests/network/gradient_check.hpp"

namespace rodsweep::test_product {

using namespace test;

TEMPLATE_TEST_CASE("W x + b is Eigen's, whatever the numbers of rows, items and inputs", "", float, double) {
  for (const int rows : {1, 6, 8, 15, 16, 17, 31, 48, 64, 96, 150})
    for (const int items : {1, 2, 3, 5, 8, 13, 50})
      for (const int depth : {1, 2, 5, 33}) {
        CAPTURE(rows, items, depth);
        // Blocks of larger matrices, so that columns have gaps; the weights end at the end of their memory.
        const Tensor<TestType> whole = random_matrix(rows + 3, depth, 1).cast<TestType>();
        const Tensor<TestType> inputs = random_matrix(depth + 2, items, 2).cast<TestType>();
        const Tensor<TestType> bias = random_matrix(rows, 1, 3).cast<TestType>();
        const auto weight = whole.bottomRows(rows);
        const auto x = inputs.topRows(depth);
        Tensor<TestType> y = Tensor<TestType>::Constant(rows + 4, items, 7);
        const double tolerance = 1e-6 * depth;
        multiply<TestType>(weight, bias.data(), x, y.middleRows(2, rows));
        Tensor<TestType> expected = weight * x;
        CHECK((y.middleRows(2, rows) - (expected.colwise() + bias.col(0))).cwiseAbs().maxCoeff() < tolerance);
        CHECK((y.topRows(2).array() == 7).all());
        CHECK((y.bottomRows(2).array() == 7).all());
        multiply<TestType>(weight, nullptr, x, y.middleRows(2, rows));
        CHECK((y.middleRows(2, rows) - expected).cwiseAbs().maxCoeff() < tolerance);
      }
}

TEST_CASE("an item's product has the same bits alone and among others") {
  const Tensor<float> weight = random_matrix(38, 20, 1).cast<float>(), x = random_matrix(20, 15, 2).cast<float>();
  Tensor<float> all(38, 15), one(38, 1);
  multiply<float>(weight, nullptr, x, all);
  for (int i = 0; i < 15; ++i) {
    multiply<float>(weight, nullptr, x.col(i), one);
    CHECK(one == all.col(i));
  }
}

TEST_CASE("a product of narrow operands is that of the rounded ones, however many items there are") {
  for (const int rows : {16, 32, 48, 80})
    for (const int depth : {1, 16, 51})
      for (const int items : {1, 3, 8, 49}) {
        const Tensor<float> weight = Tensor<float>::Random(rows, depth), x = Tensor<float>::Random(depth, items);
        const Eigen::VectorXf bias = Eigen::VectorXf::Random(rows);
        NarrowColumns narrowed = NarrowColumns::Zero(narrow_length(depth), items);
        for (int i = 0; i < items; ++i) narrow(x.col(i).data(), depth, narrowed.col(i).data());
        Tensor<float> y(rows, items);
        NarrowMatrix(weight).multiply(bias.data(), narrowed, y);
        const Tensor<float> exact = (weight * x).colwise() + bias;
        CHECK((y - exact).cwiseAbs().maxCoeff() < (narrow_bits == 16 ? 8e-3F : 2e-6F) * std::sqrt(depth));
        NarrowMatrix(weight).multiply(nullptr, narrowed, y);
        CHECK((y.colwise() + bias - exact).cwiseAbs().maxCoeff() <
              (narrow_bits == 16 ? 8e-3F : 2e-6F) * std::sqrt(depth));
      }
  CHECK_THROWS_WITH(NarrowMatrix(Tensor<float>::Zero(6, 4)), Catch::Matchers::ContainsSubstring("6 rows"));
}

TEST_CASE("the gradients of an MLP are those of central differences, for weights and inputs") {
  const int hidden_layers = GENERATE(1, 2, 3);
  CAPTURE(hidden_layers);
  Parameters<double> p;
  WeightSource source(1);
  const Mlp<double> mlp(p, "mlp", 4, 7, 3, source, 1, hidden_layers);
  REQUIRE(static_cast<int>(p.entries().size()) == 4 + 2 * (hidden_layers - 1));
  for (double& v : p.values()) v += 0.1;  // also gives biases nonzero values
  std::vector<double> inputs(4 * 5);
  Eigen::Map<Matrix> x(inputs.data(), 4, 5);
  x = random_matrix(4, 5, 2);
  const Matrix weights = random_matrix(3, 5, 3);
  Mlp<double>::Tape tape;
  Matrix y;
  const auto loss = [&] {
    mlp.forward(p, x, tape, y);
    return y.cwiseProduct(weights).sum();
  };
  loss();
  Parameters<double> gradient = p.zeros();
  Matrix dx = Matrix::Zero(4, 5);
  mlp.backward(p, x, tape, weights, gradient, &dx);
  CHECK(gradient_error(p.values(), gradient.values(), loss) < 1e-8);
  CHECK(gradient_error(inputs, std::vector<double>(dx.data(), dx.data() + dx.size()), loss) < 1e-8);
}

}  // namespace rodsweep::test_product
