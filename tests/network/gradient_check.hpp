// Gradients against central differences, in double precision.
#pragma once

#include <functional>
#include <vector>

#include "network/layers/tensor.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test {

using Matrix = Tensor<double>;

inline Matrix random_matrix(int rows, int columns, unsigned seed) {
  Random random(seed);
  Matrix out(rows, columns);
  for (double& entry : out.reshaped()) entry = random.uniform(-1, 1);
  return out;
}

/// Largest difference between `gradient` and the central differences of `loss`, over the largest entry of `gradient`.
template <class Values, class Gradient = std::vector<double>>  // accepts a braced list
double gradient_error(Values& values, const Gradient& gradient, const std::function<double()>& loss) {
  constexpr double step = 1e-5;
  double worst = 0, largest = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = values[i];
    values[i] = value + step;
    const double above = loss();
    values[i] = value - step;
    const double below = loss();
    values[i] = value;
    worst = std::max(worst, std::abs((above - below) / (2 * step) - gradient[i]));
    largest = std::max(largest, std::abs(gradient[i]));
  }
  REQUIRE(largest > 0);
  return worst / largest;
}

}  // namespace rodsweep::test
