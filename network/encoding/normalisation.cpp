#include "network/encoding/normalisation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace rodsweep {

void Normalisation::apply(Eigen::Ref<Tensor<float>> x) const {
  x.array().colwise() -= mean;
  x.array().colwise() /= deviation;
}

FeatureStatistics::FeatureStatistics(std::vector<int> groups) : groups_(std::move(groups)) {
  const int features = std::accumulate(groups_.begin(), groups_.end(), 0);
  mean_.setZero(features);
  squares_.setZero(features);
}

void FeatureStatistics::accumulate(const TensorIn<float>& x) {
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const auto value = x.col(i).cast<double>().array();
    const Eigen::ArrayXd off = value - mean_;
    mean_ += off / ++count_;
    squares_ += off * (value - mean_);
  }
}

Normalisation FeatureStatistics::normalisation() const {
  if (count_ == 0) throw std::logic_error("a normalisation needs at least one item");
  constexpr double floor = 0.1, single_precision = 1e-6;
  Eigen::ArrayXd deviation = (squares_ / count_).sqrt();
  Eigen::Index first = 0;
  for (const int size : groups_) {
    auto group = deviation.segment(first, size);
    const double pooled = std::sqrt(group.square().mean());
    const double magnitude = mean_.segment(first, size).abs().maxCoeff();
    if (pooled > single_precision * magnitude)
      group = group.max(floor * pooled);
    else
      group = magnitude > 0 ? magnitude : 1;
    first += size;
  }
  return {mean_.cast<float>(), deviation.cast<float>()};
}

}  // namespace rodsweep
