// Backward passes against central differences, in double precision.
#include <catch2/catch.hpp>

#include "network/layers/mlp.hpp"
#include "tests/network/gradient_check.hpp"

namespace rodsweep::test_gradients {

using namespace test;

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

}  // namespace rodsweep::test_gradients
