// Means and deviations of features, and the loss on normalised outputs.
#include <cmath>
#include <stdexcept>

#include "network/encoding/normalisation.hpp"
#include "network/training/mse_loss.hpp"
#include "tests/network/gradient_check.hpp"

namespace rodsweep::test_normalisation {

using namespace test;

TEST_CASE("normalised features have mean 0 and deviation 1") {
  Tensor<float> x = (50 * random_matrix(3, 400, 1)).cast<float>();
  x.row(1).array() += 1e4F;
  FeatureStatistics statistics({1, 1, 1});
  statistics.accumulate(x.leftCols(100));
  statistics.accumulate(x.rightCols(300));
  const Normalisation n = statistics.normalisation();
  Tensor<float> y = x;
  n.apply(y);
  for (int i = 0; i < 3; ++i) {
    CHECK(y.row(i).cast<double>().mean() == Approx(0).margin(1e-4));
    CHECK(std::sqrt(y.row(i).cast<double>().squaredNorm() / 400) == Approx(1).epsilon(1e-4));
  }
}

TEST_CASE("statistics don't depend on how the columns are handed over, to the bit") {
  const Tensor<float> x = random_matrix(4, 60, 2).cast<float>();
  FeatureStatistics whole({4}), parts({4});
  whole.accumulate(x);
  for (int i = 0; i < 60; i += 5) parts.accumulate(x.middleCols(i, 5));
  CHECK((whole.normalisation().mean == parts.normalisation().mean).all());
  CHECK((whole.normalisation().deviation == parts.normalisation().deviation).all());
}

TEST_CASE("a component that hardly varies is divided by a tenth of its group's deviation") {
  Tensor<float> x = random_matrix(4, 500, 3).cast<float>();
  x.row(2) *= 1e-6F;
  FeatureStatistics statistics({3, 1});
  statistics.accumulate(x);
  const Eigen::ArrayXf d = statistics.normalisation().deviation;
  CHECK(d[2] == Approx(0.1 * std::sqrt((d[0] * d[0] + d[1] * d[1]) / 3)));
  CHECK(d[0] == Approx(1 / std::sqrt(3)).epsilon(0.1));
  CHECK(d[3] == Approx(1 / std::sqrt(3)).epsilon(0.1));
}

TEST_CASE("a group that does not vary is divided by its size, or by one where it is zero") {
  Tensor<float> x(3, 100);
  x.row(0).setConstant(1e6F);
  for (int i = 0; i < 100; ++i) x(0, i) = std::nextafter(1e6F, i % 2 ? 0.F : 2e6F);  // varies by rounding only
  x.row(1).setConstant(-20);
  x.row(2).setZero();
  FeatureStatistics statistics({1, 1, 1});
  statistics.accumulate(x);
  const Eigen::ArrayXf d = statistics.normalisation().deviation;
  CHECK(d[0] == Approx(1e6));
  CHECK(d[1] == 20);
  CHECK(d[2] == 1);
}

TEST_CASE("the mean squared error and its gradient, whole and in parts") {
  std::vector<double> values(12);
  Eigen::Map<Matrix> y(values.data(), 3, 4);
  y = random_matrix(3, 4, 1);
  const Matrix target = random_matrix(3, 4, 2);
  Matrix dy, d_left, d_right;
  const double loss = mse_loss<double>(y, target, 12, &dy);
  CHECK(loss == Approx((y - target).array().square().mean()));
  CHECK(gradient_error(values, {dy.data(), dy.data() + 12}, [&] { return mse_loss<double>(y, target, 12, nullptr); }) <
        1e-9);
  const double parts = mse_loss<double>(y.leftCols(1), target.leftCols(1), 12, &d_left) +
                       mse_loss<double>(y.rightCols(3), target.rightCols(3), 12, &d_right);
  CHECK(parts == Approx(loss));
  CHECK((dy.leftCols(1) - d_left).norm() == 0);
  CHECK((dy.rightCols(3) - d_right).norm() == 0);
}

}  // namespace rodsweep::test_normalisation
