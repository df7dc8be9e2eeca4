// Means and their intervals against those of analysis/rodsweep/reading/intervals.py on the same numbers: the generators
// differ, so the ends agree as far as the number of resamples lets them.
#include <catch2/catch.hpp>
#include <cmath>

#include "runner/file/bootstrap.hpp"

using namespace rodsweep;

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

}  // namespace

TEST_CASE("means and intervals over few draws are those of the analysis") {
  Eigen::MatrixXd values(12, 3);
  std::vector<std::int64_t> draws;
  for (int i = 0; i < 12; ++i) {
    const double value = std::sin(1.0 + 3 * i) + 0.1 * i;
    values.row(i) << value, i < 4 ? missing : value, i == 5 ? missing : value * value;
    draws.push_back(10 * (i / 2));  // two simulations of each
  }
  const std::vector<Estimate> found = means(values, draws);
  // intervals.mean() of the same: value, low, high, count
  CHECK(found[0].value == Approx(0.61121022));
  CHECK(found[0].low == Approx(0.23272211).margin(0.04));
  CHECK(found[0].high == Approx(0.98277242).margin(0.04));
  CHECK(found[0].count == 12);
  CHECK(found[1].value == Approx(0.81711109));
  CHECK(std::isnan(found[1].low));  // four draws are too few
  CHECK(std::isnan(found[1].high));
  CHECK(found[1].count == 8);
  CHECK(found[2].value == Approx(0.77017888));
  CHECK(found[2].low == Approx(0.45345693).margin(0.05));
  CHECK(found[2].high == Approx(1.27185119).margin(0.05));
  CHECK(found[2].count == 11);
}

TEST_CASE("means and intervals over many draws are those of the analysis, and the same every time") {
  Eigen::MatrixXd values(300, 1);
  std::vector<std::int64_t> draws;
  for (int i = 0; i < 300; ++i) values(i, 0) = std::cos(1.7 * i), draws.push_back(i);
  const Estimate found = means(values, draws).front();
  CHECK(found.value == Approx(0.00213344));
  CHECK(found.low == Approx(-0.07643849).margin(0.01));
  CHECK(found.high == Approx(0.08370144).margin(0.01));
  const Estimate again = means(values, draws).front();
  CHECK((again.low == found.low && again.high == found.high));
}

TEST_CASE("nothing has no mean, and equal values have an interval of no width") {
  CHECK(means(Eigen::MatrixXd(0, 2), {}).size() == 2);
  CHECK(std::isnan(means(Eigen::MatrixXd(0, 2), {})[0].value));
  const Estimate found = means(Eigen::MatrixXd::Constant(6, 1, 0.25), {0, 1, 2, 3, 4, 5}).front();
  CHECK((found.value == 0.25 && found.low == 0.25 && found.high == 0.25));
}
