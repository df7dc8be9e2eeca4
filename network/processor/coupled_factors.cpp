#include "network/processor/coupled_factors.hpp"

#include <cmath>

#include "network/layers/ramp.hpp"

namespace rodsweep {
namespace {

using CouplingList = std::vector<SystemPattern::Coupling>;

template <class T>
void apply(const Linear<T>& layer, const Parameters<T>& p, const TensorIn<T>& x, Tensor<T>& before, Tensor<T>& after) {
  before.resize(layer.out(), x.cols());
  layer.forward(p, x, before);
  after = ramp(before.array());
}

template <class T>
void apply_back(const Linear<T>& layer, const Parameters<T>& p, const TensorIn<T>& x, const Tensor<T>& before,
                const Tensor<T>& d_after, Parameters<T>& gradient, Tensor<T>* dx) {
  if (dx) dx->setZero(x.rows(), x.cols());
  layer.backward(p, x, d_after.cwiseProduct(ramp_derivative(before.array()).matrix()), gradient, dx);
}

/// [x_k; sums of x over later places, one per side of k].
template <class T>
Tensor<T> with_later(const CouplingList& couplings, const Tensor<T>& x) {
  const Eigen::Index h = x.rows();
  Tensor<T> out = Tensor<T>::Zero(3 * h, x.cols());
  out.topRows(h) = x;
  for (const auto& c : couplings) out.col(c.column).segment(h * (1 + c.column_side), h) += x.col(c.row);
  return out;
}

/// Derivatives with respect to x from those with respect to with_later().
template <class T>
Tensor<T> with_earlier(const CouplingList& couplings, const Tensor<T>& d) {
  const Eigen::Index h = d.rows() / 3;
  Tensor<T> out = d.topRows(h);
  for (const auto& c : couplings) out.col(c.row) += d.col(c.column).segment(h * (1 + c.column_side), h);
  return out;
}

/// The lower triangle of C C^T from that of C.
template <class T>
void square(const T* c, T* n) {
  Eigen::Matrix<T, 6, 6> full = Eigen::Matrix<T, 6, 6>::Zero();
  for (int j = 0; j < 6; ++j)
    for (int i = j; i < 6; ++i) full(i, j) = *c++;
  for (int j = 0; j < 6; ++j)
    for (int i = j; i < 6; ++i) *n++ = full.row(i).dot(full.row(j));
}

/// Derivatives with respect to C's triangle from those with respect to the triangle of C C^T.
template <class T>
void square_back(const T* c, const T* dn, T* dc) {
  Eigen::Matrix<T, 6, 6> full = Eigen::Matrix<T, 6, 6>::Zero(), d;
  for (int j = 0; j < 6; ++j)
    for (int i = j; i < 6; ++i, ++dn) {
      full(i, j) = *c++;
      d(i, j) = d(j, i) = i == j ? 2 * *dn : *dn;
    }
  for (int j = 0; j < 6; ++j)
    for (int i = j; i < 6; ++i) *dc++ = d.row(i).dot(full.col(j));
}

}  // namespace

Tensor<float> coupling_features(const CouplingList& couplings, Eigen::Index places) {
  std::vector<int> height(static_cast<std::size_t>(places), 0);
  Tensor<float> out = Tensor<float>::Zero(6, places);
  for (auto c = couplings.rbegin(); c != couplings.rend(); ++c) {
    int& of_column = height[static_cast<std::size_t>(c->column)];
    of_column = std::max(of_column, height[static_cast<std::size_t>(c->row)] + 1);
    out(4, c->row) += 0.25F;
    out(5, c->column) += 0.25F;
  }
  for (Eigen::Index i = 0; i < places; ++i)
    for (int q = 0; q < 4; ++q)
      out(q, i) = std::exp(-static_cast<float>(height[static_cast<std::size_t>(i)]) / static_cast<float>(1 << 2 * q));
  return out;
}

template <class T>
CoupledFactors<T>::CoupledFactors(Parameters<T>& parameters, int latent, WeightSource& source)
    : latent_(latent),
      message_(parameters, "message", 36, 2 * latent, source),
      encode_(parameters, "encode", own_features + 4 * latent, latent, source),
      join_(parameters, "join", 3 * latent, latent, source),
      join_again_(parameters, "join_again", 3 * latent, latent, source),
      factors_(parameters, "factors", latent, CoupledPasses<T>::size, source, 0.1) {
  T* bias = parameters[factors_.bias()].data();
  for (int c = 0; c < 6; bias += 6 - c, ++c) *bias = 1;
}

template <class T>
void CoupledFactors<T>::predict(const Parameters<T>& p, const ScaledSystem<T>& systems, Tape& t) const {
  const Eigen::Index n = systems.diagonal.cols(), h = latent_;
  apply<T>(message_, p, systems.coupling, t.before_m, t.m);
  t.x.setZero(own_features + 4 * h, n);
  for (Eigen::Index k = 0; k < n; ++k)
    for (int c = 0, to = 0; c < 6; ++c)
      for (int r = c; r < 6; ++r, ++to) t.x(to, k) = systems.diagonal(6 * c + r, k) - (r == c ? 1 : 0);
  t.x.middleRows(triangle, coupling_features) = rodsweep::coupling_features(systems.couplings, n).template cast<T>();
  for (const auto& c : systems.couplings) {
    t.x.col(c.row).segment(own_features + h * c.side, h) += t.m.col(c.block).head(h);
    t.x.col(c.column).segment(own_features + h * (2 + c.column_side), h) += t.m.col(c.block).tail(h);
  }
  apply<T>(encode_, p, t.x, t.before_e, t.e);
  t.e = with_later(systems.couplings, t.e);
  apply<T>(join_, p, t.e, t.before_f, t.f);
  t.f = with_later(systems.couplings, t.f);
  apply<T>(join_again_, p, t.f, t.before_g, t.g);
  t.outputs.resize(CoupledPasses<T>::size, n);
  factors_.forward(p, t.g, t.outputs);
  t.factors = t.outputs;
  for (Eigen::Index k = 0; k < n; ++k) square(t.outputs.col(k).data(), t.factors.col(k).data());
}

template <class T>
void CoupledFactors<T>::forward(const Parameters<T>& p, const ScaledSystem<T>& systems, Tape& t, Tensor<T>& y) const {
  predict(p, systems, t);
  t.passes.forward(systems, t.factors, systems.residual);
  y = t.passes.y;
}

template <class T>
void CoupledFactors<T>::backward(const Parameters<T>& p, const ScaledSystem<T>& systems, const Tape& t,
                                 const TensorIn<T>& dy, Parameters<T>& gradient) const {
  Tensor<T> d_factors;
  t.passes.backward(systems, t.factors, dy, d_factors);
  learn(p, systems, t, d_factors, gradient);
}

template <class T>
void CoupledFactors<T>::learn(const Parameters<T>& p, const ScaledSystem<T>& systems, const Tape& t,
                              const TensorIn<T>& d_factors, Parameters<T>& gradient) const {
  const Eigen::Index n = systems.diagonal.cols(), h = latent_;
  Tensor<T> d, d_sums;
  Tensor<T> d_outputs = d_factors;
  for (Eigen::Index k = 0; k < n; ++k)
    square_back(t.outputs.col(k).data(), d_factors.col(k).data(), d_outputs.col(k).data());
  d.setZero(h, n);
  factors_.backward(p, t.g, d_outputs, gradient, &d);
  apply_back<T>(join_again_, p, t.f, t.before_g, d, gradient, &d_sums);
  d = with_earlier(systems.couplings, d_sums);
  apply_back<T>(join_, p, t.e, t.before_f, d, gradient, &d_sums);
  d = with_earlier(systems.couplings, d_sums);
  apply_back<T>(encode_, p, t.x, t.before_e, d, gradient, &d_sums);
  Tensor<T> dm(2 * h, systems.coupling.cols());
  for (const auto& c : systems.couplings) {
    dm.col(c.block).head(h) = d_sums.col(c.row).segment(own_features + h * c.side, h);
    dm.col(c.block).tail(h) = d_sums.col(c.column).segment(own_features + h * (2 + c.column_side), h);
  }
  apply_back<T>(message_, p, systems.coupling, t.before_m, dm, gradient, nullptr);
}

template class CoupledFactors<float>;
template class CoupledFactors<double>;

}  // namespace rodsweep
