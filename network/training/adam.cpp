#include "network/training/adam.hpp"

#include <cmath>
#include <limits>
#include <numeric>

namespace rodsweep {

Adam::Adam(std::size_t size, const Settings& settings) : settings_(settings), mean_(size), square_(size) {}

double Adam::usual_norm() const {
  if (steps_ < 100) return std::numeric_limits<double>::infinity();
  const double sum = std::accumulate(square_.begin(), square_.end(), 0.0);
  return std::sqrt(sum / (1 - std::pow(settings_.beta2, static_cast<double>(steps_))));
}

void Adam::step(double rate, const AlignedVector<float>& gradient, AlignedVector<float>& weights) {
  ++steps_;
  const auto beta1 = static_cast<float>(settings_.beta1), beta2 = static_cast<float>(settings_.beta2);
  const auto scale1 = static_cast<float>(rate / (1 - std::pow(settings_.beta1, static_cast<double>(steps_))));
  const auto scale2 = static_cast<float>(1 / (1 - std::pow(settings_.beta2, static_cast<double>(steps_))));
  const auto epsilon = static_cast<float>(settings_.epsilon), decay = static_cast<float>(rate * settings_.weight_decay);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    mean_[i] = beta1 * mean_[i] + (1 - beta1) * gradient[i];
    square_[i] = beta2 * square_[i] + (1 - beta2) * gradient[i] * gradient[i];
    weights[i] -= scale1 * mean_[i] / (std::sqrt(square_[i] * scale2) + epsilon) + decay * weights[i];
  }
}

void Adam::restore(std::int64_t steps, const AlignedVector<float>& mean, const AlignedVector<float>& square) {
  steps_ = steps;
  mean_ = mean;
  square_ = square;
}

}  // namespace rodsweep
