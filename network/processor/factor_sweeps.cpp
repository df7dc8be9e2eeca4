#include "network/processor/factor_sweeps.hpp"

#include <cmath>

#include "network/layers/ramp.hpp"
#include "network/processor/six_blocks.hpp"

namespace rodsweep {
namespace {

using namespace six;

/// B_i.
template <class T>
Block<T> b(const TensorIn<T>& x, int i) {
  return block(x.col(i).data() + FactorSweeps<T>::coupling);
}

/// [x_k; sum over children of x_c].
template <class T>
Tensor<T> with_children(const JointForest& forest, const Tensor<T>& x) {
  const Eigen::Index h = x.rows();
  Tensor<T> out = Tensor<T>::Zero(2 * h, x.cols());
  out.topRows(h) = x;
  for (int i = 0; i < forest.size(); ++i)
    if (const int parent = forest.parent[at(i)]; parent >= 0) out.col(parent).tail(h) += x.col(i);
  return out;
}

/// Derivatives with respect to x from those with respect to [x_k; sum of x_c].
template <class T>
Tensor<T> with_parents(const JointForest& forest, const Tensor<T>& d) {
  const Eigen::Index h = d.rows() / 2;
  Tensor<T> out = d.topRows(h);
  for (int i = 0; i < forest.size(); ++i)
    if (const int parent = forest.parent[at(i)]; parent >= 0) out.col(i) += d.col(parent).tail(h);
  return out;
}

template <class T>
void apply(const Linear<T>& layer, const Parameters<T>& p, const Tensor<T>& x, Tensor<T>& before, Tensor<T>& after) {
  before.resize(layer.out(), x.cols());
  layer.forward(p, x, before);
  after = ramp(before.array());
}

template <class T>
Tensor<T> apply_back(const Linear<T>& layer, const Parameters<T>& p, const Tensor<T>& x, const Tensor<T>& before,
                     const Tensor<T>& d_after, Parameters<T>& gradient) {
  Tensor<T> out = Tensor<T>::Zero(x.rows(), x.cols());
  layer.backward(p, x, d_after.cwiseProduct(ramp_derivative(before.array()).matrix()), gradient, &out);
  return out;
}

template <class T>
bool carried(const Column<T>& state) {
  return sum<T>(state * state) < FactorSweeps<T>::longest_state * FactorSweeps<T>::longest_state;
}

}  // namespace

Tensor<float> place_features(const JointForest& forest) {
  std::vector<int> height(at(forest.size()), 0);
  Tensor<float> out(5, forest.size());
  for (int i = forest.size() - 1; i >= 0; --i) {
    const int parent = forest.parent[at(i)];
    if (parent >= 0) height[at(parent)] = std::max(height[at(parent)], height[at(i)] + 1);
    for (int q = 0; q < 4; ++q)
      out(q, i) = std::exp(-static_cast<float>(height[at(i)]) / static_cast<float>(1 << 2 * q));
    out(4, i) = static_cast<float>(forest.beside[at(i)]) / 4;
  }
  return out;
}

template <class T>
FactorSweeps<T>::FactorSweeps(Parameters<T>& parameters, int latent, WeightSource& source)
    : latent_(latent),
      encode_(parameters, "encode", block_features + place_features, latent, source),
      join_(parameters, "join", 2 * latent, latent, source),
      join_again_(parameters, "join_again", 2 * latent, latent, source),
      factors_(parameters, "factors", latent, 2 * triangle, source, 0.3) {
  T* bias = parameters[factors_.bias()].data();
  for (int c = 0; c < 6; bias += 6 - c, ++c) *bias = 1;
}

template <class T>
void FactorSweeps<T>::forward(const Parameters<T>& p, const JointForest& forest, const TensorIn<T>& x, Tape& t,
                              Tensor<T>& y) const {
  const Eigen::Index n = x.cols();
  t.a.resize(block_features + place_features, n);
  t.a.topRows(block_features) = x.bottomRows(block_features);
  t.a.bottomRows(place_features) = rodsweep::place_features(forest).template cast<T>();
  apply(encode_, p, t.a, t.before_e, t.e);
  t.e = with_children(forest, t.e);
  apply(join_, p, t.e, t.before_f, t.f);
  t.f = with_children(forest, t.f);
  apply(join_again_, p, t.f, t.before_g, t.g);
  t.factors.resize(2 * triangle, n);
  factors_.forward(p, t.g, t.factors);

  t.h = x.topRows(residual_features);
  for (int i = forest.size() - 1; i >= 0; --i) {
    const int parent = forest.parent[at(i)];
    const Column<T> h = column(&t.h(0, i));
    if (parent >= 0 && carried<T>(h))
      add<T>(-transposed_times(b(x, i), times(symmetric(&t.factors(triangle, i)), h)), &t.h(0, parent));
  }
  t.v.setZero(6, n);
  y.setZero(6, n);
  for (int i = 0; i < forest.size(); ++i) {
    const int parent = forest.parent[at(i)];
    add<T>(times(symmetric(&t.factors(0, i)), column(&t.h(0, i))), &y(0, i));
    if (parent < 0 || !carried<T>(column(&y(0, parent)))) continue;
    const Column<T> v = -times(b(x, i), column(&y(0, parent)));
    add<T>(v, &t.v(0, i));
    add<T>(times(symmetric(&t.factors(triangle, i)), v), &y(0, i));
  }
  t.y = y;
}

template <class T>
void FactorSweeps<T>::backward(const Parameters<T>& p, const JointForest& forest, const TensorIn<T>& x, const Tape& t,
                               const TensorIn<T>& dy, Parameters<T>& gradient) const {
  const Eigen::Index n = x.cols();
  Tensor<T> d = dy, dh = Tensor<T>::Zero(6, n), d_factors = Tensor<T>::Zero(2 * triangle, n);
  for (int i = forest.size() - 1; i >= 0; --i) {
    const Column<T> di = column(&d(0, i));
    add<T>(times(symmetric(&t.factors(0, i)), di), &dh(0, i));
    add_derivatives<T>(di, column(&t.h(0, i)), &d_factors(0, i));
    const int parent = forest.parent[at(i)];
    if (parent < 0 || !carried<T>(column(&t.y(0, parent)))) continue;
    add_derivatives<T>(di, column(&t.v(0, i)), &d_factors(triangle, i));
    add<T>(-transposed_times(b(x, i), times(symmetric(&t.factors(triangle, i)), di)), &d(0, parent));
  }
  for (int i = 0; i < forest.size(); ++i) {
    const int parent = forest.parent[at(i)];
    const Column<T> h = column(&t.h(0, i));
    if (parent < 0 || !carried<T>(h)) continue;
    const Column<T> dw = -times(b(x, i), column(&dh(0, parent)));
    add_derivatives<T>(dw, h, &d_factors(triangle, i));
    add<T>(times(symmetric(&t.factors(triangle, i)), dw), &dh(0, i));
  }
  Tensor<T> dg = Tensor<T>::Zero(latent_, n);
  factors_.backward(p, t.g, d_factors, gradient, &dg);
  const Tensor<T> df = with_parents(forest, apply_back(join_again_, p, t.f, t.before_g, dg, gradient));
  const Tensor<T> de = with_parents(forest, apply_back(join_, p, t.e, t.before_f, df, gradient));
  encode_.backward(p, t.a, de.cwiseProduct(ramp_derivative(t.before_e.array()).matrix()), gradient, nullptr);
}

template class FactorSweeps<float>;
template class FactorSweeps<double>;

}  // namespace rodsweep
