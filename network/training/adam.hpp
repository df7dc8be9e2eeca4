// Adam (Kingma & Ba 2015) on a flat array, with decoupled weight decay (Loshchilov & Hutter 2019).
#pragma once

#include <cstdint>

#include "network/layers/tensor.hpp"

namespace rodsweep {

class Adam {
 public:
  struct Settings {
    double beta1 = 0.9, beta2 = 0.999, epsilon = 1e-8, weight_decay = 0;
  };
  Adam(std::size_t size, const Settings& settings);

  const AlignedVector<float>& mean() const { return mean_; }
  const AlignedVector<float>& square() const { return square_; }
  /// Continues from earlier moments after that many steps.
  void restore(std::int64_t steps, const AlignedVector<float>& mean, const AlignedVector<float>& square);

  /// The root mean square of recent gradients' norms; infinite in the first hundred steps, which are too few.
  double usual_norm() const;

  /// weights -= rate * (m / (1 - beta1^t) / (sqrt(v / (1 - beta2^t)) + epsilon) + weight_decay * weights)
  void step(double rate, const AlignedVector<float>& gradient, AlignedVector<float>& weights);

 private:
  Settings settings_;
  std::int64_t steps_ = 0;
  AlignedVector<float> mean_, square_;
};

}  // namespace rodsweep
