// Features shifted and scaled to mean 0 and standard deviation 1 over a training set.
//
// Features come in groups, the components of one quantity: a component that hardly varies (z of a planar motion) is
// divided by a tenth of the group's root mean square deviation. A group that is constant in single precision is divided
// by its own size, so that other values remain of order one.
#pragma once

#include <vector>

#include "network/layers/tensor.hpp"

namespace rodsweep {

/// The scales of a model, one per feature: the network's input is (x - mean) / deviation.
struct Normalisation {
  Eigen::ArrayXf mean, deviation;

  void apply(Eigen::Ref<Tensor<float>> x) const;
};

class FeatureStatistics {
 public:
  /// Sizes of the groups, in the order of the features.
  explicit FeatureStatistics(std::vector<int> groups);

  /// Adds every column, in order: the same columns in the same order give the same bits.
  void accumulate(const TensorIn<float>& x);
  /// Throws std::logic_error before the first column.
  Normalisation normalisation() const;

 private:
  std::vector<int> groups_;
  double count_ = 0;
  Eigen::ArrayXd mean_, squares_;  ///< Welford's running mean and sum of squared deviations
};

}  // namespace rodsweep
