#include "solver/guess/normal_equations.hpp"

#include <algorithm>
#include <cmath>

namespace rodsweep {
namespace {

using Mask8 = long __attribute__((vector_size(64)));

/// y -= a x.
inline void subtract(Lane8* y, double a, const Lane8* x, std::size_t width) {
  for (std::size_t w = 0; w < width; ++w) y[w] -= a * x[w];
}

}  // namespace

NormalEquations::NormalEquations(int most, double smallest_pivot)
    : width_(at((most + 7) / 8)),
      smallest_pivot_(smallest_pivot),
      gram_(at(most) * width_),
      lower_(gram_),
      scale_(width_),
      coefficients_(width_),
      inverse_pivot_(at(most)) {}

void NormalEquations::factorise(int count, double damping) {
  count_ = count;
  std::fill(scale_.begin(), scale_.end(), Lane8{});  // zeros remove entries beyond `count`
  for (int k = 0; k < count; ++k) {
    const double squared = gram(k, k);
    entries(scale_, 0)[k] = squared > 0 ? 1 / std::sqrt(squared) : 0;
  }
  for (int k = 0; k < count; ++k) {
    Lane8* own = column(gram_, k);
    for (std::size_t w = 0; w < width_; ++w) own[w] *= entries(scale_, 0)[k] * scale_[w];
    gram(k, k) += damping * damping;
  }
  for (int k = 0; k < count; ++k) {
    const double pivot = gram(k, k);
    const bool kept = pivot > smallest_pivot_;
    const double inverse = kept ? 1 / pivot : 0;
    inverse_pivot_[at(k)] = inverse;
    Lane8* own = column(gram_, k);
    Lane8* below = column(lower_, k);
    if (!kept) continue;
    for (std::size_t w = 0; w < width_; ++w) {
      const Mask8 row = Mask8{0, 1, 2, 3, 4, 5, 6, 7} + 8 * static_cast<long>(w);
      below[w] = row > long{k} ? inverse * own[w] : Lane8{};
      own[w] = row > long{k} ? Lane8{} : own[w];
    }
    for (int j = k + 1; j < count; ++j) subtract(column(gram_, j), gram(k, j), below, width_);
  }
}

void NormalEquations::solve() {
  double* c = entries(coefficients_, 0);
  for (std::size_t w = 0; w < width_; ++w) coefficients_[w] *= scale_[w];
  const auto inverse = [&](int k) { return inverse_pivot_[at(k)]; };
  for (int k = 0; k < count_; ++k)
    if (inverse(k) > 0) subtract(coefficients_.data(), c[k], column(lower_, k), width_);
  for (int k = count_ - 1; k >= 0; --k) {
    if (inverse(k) > 0) {
      const double own = inverse(k) * c[k];
      subtract(coefficients_.data(), own, column(gram_, k), width_);
      c[k] = own;
    } else {
      c[k] = 0;
    }
  }
  for (std::size_t w = 0; w < width_; ++w) coefficients_[w] *= scale_[w];
}

void NormalEquations::factorise(const Eigen::MatrixXd& gram_of, const Eigen::VectorXi& order, int count,
                                double damping) {
  for (int k = 0; k < count; ++k)
    for (int i = 0; i < count; ++i) gram(i, k) = gram_of(order[i], order[k]);
  factorise(count, damping);
}

void NormalEquations::solve(const Eigen::VectorXi& order, VectorX& c) {
  for (int i = 0; i < count_; ++i) right_side(i) = c[order[i]];
  solve();
  c.setZero();
  for (int i = 0; i < count_; ++i) c[order[i]] = coefficient(i);
}

}  // namespace rodsweep
