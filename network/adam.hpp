// Adam (Kingma & Ba 2015) on a flat array, with decoupled weight decay (Loshchilov & Hutter 2019).
#pragma once

#include <vector>

namespace rodsweep {

class Adam {
 public:
  struct Settings {
    double beta1 = 0.9, beta2 = 0.999, epsilon = 1e-8, weight_decay = 0;
  };
  Adam(std::size_t size, const Settings& settings);

  /// weights -= rate * (m / (1 - beta1^t) / (sqrt(v / (1 - beta2^t)) + epsilon) + weight_decay * weights)
  void step(double rate, const std::vector<float>& gradient, std::vector<float>& weights);

 private:
  Settings settings_;
  long steps_ = 0;
  std::vector<float> mean_, square_;
};

}  // namespace rodsweep
