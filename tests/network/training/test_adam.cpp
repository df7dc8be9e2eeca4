// Adam against its definition, and on a problem with a known minimum.
#include <catch2/catch.hpp>
#include <cmath>

#include "network/training/adam.hpp"

namespace rodsweep::test_adam {

TEST_CASE("the first step is the rate times the gradient's sign, whatever its size") {
  AlignedVector<float> weights{1, 2, 3};
  Adam adam(3, {});
  adam.step(0.1, {1e-3F, -50, 0}, weights);
  CHECK(weights[0] == Approx(0.9).epsilon(1e-4));
  CHECK(weights[1] == Approx(2.1).epsilon(1e-4));
  CHECK(weights[2] == 3);
}

TEST_CASE("two steps follow the definition") {
  AlignedVector<float> weights{0.5F};
  Adam adam(1, {0.8, 0.9, 1e-8, 0.01});
  double m = 0, v = 0, w = 0.5;
  for (int t = 1; t <= 2; ++t) {
    const double g = t == 1 ? 0.3 : -0.7;
    m = 0.8 * m + 0.2 * g;
    v = 0.9 * v + 0.1 * g * g;
    w -= 0.05 * (m / (1 - std::pow(0.8, t)) / (std::sqrt(v / (1 - std::pow(0.9, t))) + 1e-8) + 0.01 * w);
    adam.step(0.05, {static_cast<float>(g)}, weights);
  }
  CHECK(weights[0] == Approx(w).epsilon(1e-6));
}

TEST_CASE("it finds the minimum of a badly scaled quadratic") {
  AlignedVector<float> weights{5, -3};
  Adam adam(2, {});
  for (int i = 0; i < 3000; ++i)
    adam.step(0.02 * (1 - i / 3000.0), {1000 * (weights[0] - 1), 0.01F * (weights[1] - 2)}, weights);
  CHECK(weights[0] == Approx(1).margin(1e-3));
  CHECK(weights[1] == Approx(2).margin(1e-2));
}

}  // namespace rodsweep::test_adam
