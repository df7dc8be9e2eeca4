#include "network/training/correction_loss.hpp"

#include <cmath>

namespace rodsweep {
namespace {

/// The columns of system `s`.
template <class M>
auto part(M& columns, const std::vector<int>& first, std::size_t s) {
  return columns.middleCols(first[s], first[s + 1] - first[s]);
}

/// to += sign c_s x, system by system.
template <class T>
void add(const ScaledSystem<T>& a, int sign, const std::vector<T>& c, const Tensor<T>& x, Tensor<T>& to) {
  for (std::size_t s = 0; s < c.size(); ++s)
    part(to, a.first_place, s) += static_cast<T>(sign) * c[s] * part(x, a.first_place, s);
}

template <class T>
double dot(const ScaledSystem<T>& a, const Tensor<T>& x, const Tensor<T>& y, std::size_t s) {
  return static_cast<double>(part(x, a.first_place, s).cwiseProduct(part(y, a.first_place, s)).sum());
}

constexpr double smallest_ratio = 1e-8;  // limit of E / x^T A x; below is rounding

}  // namespace

template <class T>
double CorrectionLoss<T>::operator()(const ScaledSystem<T>& a, const TensorIn<T>& factors, Tensor<T>* d_factors) {
  const auto systems = static_cast<std::size_t>(a.systems());
  std::vector<double> energy = a.base_energy, before(systems, 0);
  r_ = a.residual;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    Step& step = steps_[i];
    step.answer.forward(a, factors, r_);
    step.p = step.answer.y;
    step.length.assign(systems, 0);
    step.kept.assign(systems, 0);
    std::vector<double> along(systems);
    for (std::size_t s = 0; s < systems; ++s) {
      along[s] = dot(a, r_, step.answer.y, s);
      if (before[s] > 0) step.kept[s] = static_cast<T>(along[s] / before[s]);
    }
    if (i > 0) add(a, 1, step.kept, steps_[i - 1].p, step.p);
    step.ap.resize(6, r_.cols());
    multiply<T>(a, step.p, step.ap);
    for (std::size_t s = 0; s < systems; ++s) {
      const double curvature = dot(a, step.p, step.ap, s);
      if (!(curvature > 0) || !(along[s] > 0)) continue;
      step.length[s] = static_cast<T>(along[s] / curvature);
      energy[s] -= along[s] / curvature * along[s];
    }
    add(a, -1, step.length, step.ap, r_);
    before = along;
  }
  double loss = 0;
  std::vector<T> slope(systems);
  for (std::size_t s = 0; s < systems; ++s) {
    const double ratio = std::max(energy[s] / a.unit_energy[s], smallest_ratio);
    loss += std::sqrt(ratio);
    slope[s] = ratio > smallest_ratio ? static_cast<T>(1 / (std::sqrt(ratio) * a.unit_energy[s])) : T(0);
  }
  if (!d_factors) return loss;
  Tensor<T> dx = Tensor<T>::Zero(6, r_.cols());  // dE/dx = -2 r
  add(a, -1, slope, r_, dx);
  go_back(a, factors, std::move(dx), *d_factors);
  return loss;
}

/// Derivatives with respect to the factors from those with respect to the sum of all a_i p_i.
template <class T>
void CorrectionLoss<T>::go_back(const ScaledSystem<T>& a, const TensorIn<T>& factors, Tensor<T> dx,
                                Tensor<T>& d_factors) {
  d_factors.setZero(factors.rows(), factors.cols());
  Tensor<T> dr = Tensor<T>::Zero(6, dx.cols()), dp, a_dr(6, dx.cols()), by_step;
  CoupledPasses<T> back;
  for (std::size_t i = steps_.size(); i-- > 0;) {
    const Step& step = steps_[i];
    Tensor<T> here = Tensor<T>::Zero(6, dx.cols());
    add(a, 1, step.length, dx, here);
    multiply<T>(a, dr, a_dr);
    add(a, -1, step.length, a_dr, here);
    if (i + 1 < steps_.size()) add(a, 1, steps_[i + 1].kept, dp, here);
    dp = here;
    step.answer.backward(a, factors, dp, by_step);
    d_factors += by_step;
    back.forward(a, factors, dp);  // F is symmetric
    dr += back.y;
  }
}

template class CorrectionLoss<float>;
template class CorrectionLoss<double>;

}  // namespace rodsweep
