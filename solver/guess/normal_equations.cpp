#include "solver/guess/normal_equations.hpp"

#include <cmath>

namespace rodsweep {

namespace {

constexpr double smallest_pivot = 1e-12;  // what is below is rounding error

}  // namespace

NormalEquations::NormalEquations(int most) : gram_(most, most), pivot_(most), scale_(most), coefficients_(most) {}

void NormalEquations::factorise(int count, double damping) {
  count_ = count;
  for (int i = 0; i < count; ++i) {
    const double squared = gram_(i, i);
    scale_[i] = squared > 0 ? 1 / std::sqrt(squared) : 0;
    pivot_[i] = squared > 0 ? 1 + damping * damping : 0;
    for (int k = 0; k < i; ++k) {
      double sum = scale_[i] * scale_[k] * gram_(i, k);
      for (int m = 0; m < k; ++m) sum -= gram_(i, m) * gram_(k, m) * pivot_[m];
      gram_(i, k) = pivot_[k] > 0 ? sum / pivot_[k] : 0;
      pivot_[i] -= gram_(i, k) * gram_(i, k) * pivot_[k];
    }
    if (!(pivot_[i] > smallest_pivot)) pivot_[i] = 0;
  }
}

void NormalEquations::solve() {
  VectorX& c = coefficients_;
  for (int i = 0; i < count_; ++i) {
    c[i] *= scale_[i];
    for (int k = 0; k < i; ++k) c[i] -= gram_(i, k) * c[k];
    if (pivot_[i] == 0) c[i] = 0;
  }
  for (int i = count_ - 1; i >= 0; --i) {
    if (pivot_[i] == 0) continue;
    c[i] /= pivot_[i];
    for (int k = i + 1; k < count_; ++k) c[i] -= gram_(k, i) * c[k];
  }
  for (int i = 0; i < count_; ++i) c[i] *= scale_[i];
}

}  // namespace rodsweep
