// Bootstrap confidence intervals of means over simulations, as analysis/rodsweep/reading/intervals.py has them: what is
// resampled is the draw of the random parameters, which grid points share; fewer than five draws give no interval; the
// level of the percentile interval is raised for few draws as Hesterberg (2015, "What teachers should know about the
// bootstrap", expanded percentile) says. The generator is seeded: the same values have the same interval.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

namespace rodsweep {

struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double low = value, high = value;  ///< of the 95 % interval; NaN: too few draws
  std::int64_t count = 0;            ///< simulations that contributed
};

/// Of every column of `values`, a row per simulation; NaN is left out. `draws`: which draw each simulation is of.
std::vector<Estimate> means(const Eigen::MatrixXd& values, const std::vector<std::int64_t>& draws);

}  // namespace rodsweep
