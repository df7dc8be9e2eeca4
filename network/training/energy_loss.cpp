#include "network/training/energy_loss.hpp"

#include <cmath>

namespace rodsweep {
namespace {

/// The columns of system `s`.
template <class M>
auto part(M& columns, const std::vector<int>& first, int s) {
  const auto i = static_cast<std::size_t>(s);
  return columns.middleCols(first[i], first[i + 1] - first[i]);
}

template <class A, class B>
double dot(const A& a, const B& b) {
  return static_cast<double>(a.cwiseProduct(b).sum());
}

constexpr double smallest_energy_ratio = 1e-12;  // limit of E / x^T A x; below is rounding

}  // namespace

template <class T>
double EnergyLoss<T>::operator()(const ScaledSystem<T>& a, const TensorIn<T>& d, Tensor<T>* gradient) {
  ad_.resize(6, d.cols());
  multiply<T>(a, d, ad_);
  r_ = a.residual;
  energy_ = a.base_energy;
  std::vector<double> length(energy_.size()), curvature(energy_.size());
  for (int s = 0; s < a.systems(); ++s) {
    const auto i = static_cast<std::size_t>(s);
    const auto ds = part(d, a.first_place, s);
    const double along = dot(ds, part(a.residual, a.first_place, s));
    curvature[i] = dot(ds, part(ad_, a.first_place, s));
    length[i] = !best_length_ ? 1 : curvature[i] > 0 ? along / curvature[i] : 0;
    energy_[i] += length[i] * (length[i] * curvature[i] - 2 * along);
    part(r_, a.first_place, s) -= static_cast<T>(length[i]) * part(ad_, a.first_place, s);
  }
  iterate(a);
  if (gradient) apply_polynomial(a);

  double loss = 0;
  if (gradient) gradient->resize(6, d.cols());
  for (int s = 0; s < a.systems(); ++s) {
    const auto i = static_cast<std::size_t>(s);
    const double ratio = std::max(energy_[i] / a.unit_energy[i], smallest_energy_ratio);
    loss += std::sqrt(ratio);
    if (!gradient) continue;
    // dE/dx0 = -2 v, v = P_k(A^) r_k, x0 = c d:  dE/dd = -2 (c v + (d.v) dc/dd),  dc/dd = (r^ - 2 c A^ d) / d.A^ d
    const auto ds = part(d, a.first_place, s);
    const auto v = part(v_, a.first_place, s);
    const double c = length[i], slope = best_length_ && curvature[i] > 0 ? dot(ds, v) / curvature[i] : 0;
    const double dloss = -1 / (std::sqrt(ratio) * a.unit_energy[i]);  // dL/dE * (-2)
    auto g = part(*gradient, a.first_place, s);
    g = static_cast<T>(dloss * c) * v + static_cast<T>(dloss * slope) * part(a.residual, a.first_place, s) -
        static_cast<T>(2 * dloss * slope * c) * part(ad_, a.first_place, s);
  }
  return loss;
}

/// CG from r_: updates r_ and energy_.
template <class T>
void EnergyLoss<T>::iterate(const ScaledSystem<T>& a) {
  const int systems = a.systems();
  steps_.resize(static_cast<std::size_t>(cg_steps_));
  ap_.resize(6, r_.cols());
  if (cg_steps_ > 0) p_ = r_;
  for (CgStep& step : steps_) {
    step.alpha.assign(static_cast<std::size_t>(systems), 0);
    step.beta.assign(static_cast<std::size_t>(systems), 0);
    multiply<T>(a, p_, ap_);
    for (int s = 0; s < systems; ++s) {
      const auto i = static_cast<std::size_t>(s);
      auto r = part(r_, a.first_place, s), p = part(p_, a.first_place, s), ap = part(ap_, a.first_place, s);
      const double rr = dot(r, r), pap = dot(p, ap);
      if (!(rr > 0) || !(pap > 0)) continue;  // solved already
      step.alpha[i] = static_cast<T>(rr / pap);
      energy_[i] -= rr * rr / pap;
      r -= step.alpha[i] * ap;
      step.beta[i] = static_cast<T>(dot(r, r) / rr);
      p = r + step.beta[i] * p;
    }
  }
}

/// v_ becomes P_k(A^) r_k, by the recurrence of the errors in iterate():
///   v_{i+1} = v_i - alpha_i p_i,   p_i = A^ v_i + beta_{i-1} p_{i-1}
template <class T>
void EnergyLoss<T>::apply_polynomial(const ScaledSystem<T>& a) {
  v_ = r_;
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    multiply<T>(a, v_, ap_);
    for (int s = 0; s < a.systems(); ++s) {
      const auto i = static_cast<std::size_t>(s);
      auto p = part(p_, a.first_place, s);
      if (k == 0)
        p = part(ap_, a.first_place, s);
      else
        p = part(ap_, a.first_place, s) + steps_[k - 1].beta[i] * p;
      part(v_, a.first_place, s) -= steps_[k].alpha[i] * p;
    }
  }
}

template class EnergyLoss<float>;
template class EnergyLoss<double>;

}  // namespace rodsweep
