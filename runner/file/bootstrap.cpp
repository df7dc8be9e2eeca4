#include "runner/file/bootstrap.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <map>
#include <random>

namespace rodsweep {
namespace {

constexpr double level = 0.95;
constexpr int fewest_draws = 5;
constexpr std::int64_t most_resamples = 4000, fewest_resamples = 1000;
constexpr std::int64_t most_drawn = 400000;  // in all resamples: with more than a hundred draws fewer resamples do
constexpr std::int64_t resamples_at_once = 64;
constexpr std::uint64_t seed = 20210;

/// By how much of the resamples the percentile interval begins above the lowest.
double tail(int draws) {
  const boost::math::students_t t(draws - 1);
  const double z = -std::sqrt(draws / (draws - 1.0)) * boost::math::quantile(t, (1 + level) / 2);
  return 0.5 * std::erfc(-z / std::sqrt(2));
}

/// With linear interpolation between neighbours. `sorted`: not empty.
double quantile(const std::vector<double>& sorted, double part) {
  const double place = part * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

/// Places from 0 for draws of whatever numbers.
std::vector<Eigen::Index> group_places(const std::vector<std::int64_t>& draws, Eigen::Index& groups) {
  std::map<std::int64_t, Eigen::Index> places;
  for (const std::int64_t draw : draws) places.emplace(draw, 0);
  groups = 0;
  for (auto& [draw, place] : places) place = groups++;
  std::vector<Eigen::Index> of_rows;
  for (const std::int64_t draw : draws) of_rows.push_back(places[draw]);
  return of_rows;
}

}  // namespace

std::vector<Estimate> means(const Eigen::MatrixXd& values, const std::vector<std::int64_t>& draws) {
  Eigen::Index groups = 0;
  const std::vector<Eigen::Index> group = group_places(draws, groups);
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(groups, values.cols()), counts = sums;
  for (Eigen::Index row = 0; row < values.rows(); ++row)
    for (Eigen::Index column = 0; column < values.cols(); ++column)
      if (const double value = values(row, column); std::isfinite(value)) {
        sums(group[static_cast<std::size_t>(row)], column) += value;
        counts(group[static_cast<std::size_t>(row)], column) += 1;
      }

  std::vector<Estimate> estimates(static_cast<std::size_t>(values.cols()));
  std::vector<int> drawn;
  for (Eigen::Index column = 0; column < values.cols(); ++column) {
    Estimate& estimate = estimates[static_cast<std::size_t>(column)];
    estimate.count = static_cast<std::int64_t>(counts.col(column).sum());
    if (estimate.count > 0) estimate.value = sums.col(column).sum() / static_cast<double>(estimate.count);
    drawn.push_back(static_cast<int>((counts.col(column).array() > 0).count()));
  }
  if (std::none_of(drawn.begin(), drawn.end(), [](int n) { return n >= fewest_draws; })) return estimates;

  const std::int64_t resamples = std::clamp(most_drawn / groups, fewest_resamples, most_resamples);
  std::vector<std::vector<double>> resampled(estimates.size());
  std::mt19937_64 random(seed);
  for (std::int64_t done = 0; done < resamples; done += resamples_at_once) {
    Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(std::min(resamples_at_once, resamples - done), groups);
    for (Eigen::Index row = 0; row < weights.rows(); ++row)
      for (Eigen::Index i = 0; i < groups; ++i)
        weights(row, static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(groups))) += 1;
    const Eigen::MatrixXd above = weights * sums, below = weights * counts;
    for (Eigen::Index column = 0; column < values.cols(); ++column)
      for (Eigen::Index row = 0; row < weights.rows(); ++row)
        if (below(row, column) > 0)
          resampled[static_cast<std::size_t>(column)].push_back(above(row, column) / below(row, column));
  }
  for (std::size_t column = 0; column < estimates.size(); ++column) {
    if (drawn[column] < fewest_draws) continue;
    std::sort(resampled[column].begin(), resampled[column].end());
    const double part = tail(drawn[column]);
    estimates[column].low = quantile(resampled[column], part);
    estimates[column].high = quantile(resampled[column], 1 - part);
  }
  return estimates;
}

}  // namespace rodsweep
