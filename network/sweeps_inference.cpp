#include "network/sweeps_inference.hpp"

#include <stdexcept>
#include <string>

#include "network/float_lanes.hpp"
#include "network/product.hpp"

namespace rodsweep {
namespace {

/// h' of one joint (network/gru.hpp) for a latent size of 16 V; u [48 V, 16 V] column-major, p [48 V].
template <int V>
void gru_step(const float* u, const float* p, const float* h, float* out) {
  // Two sets of sums, so that a multiplication need not wait for the one before.
  Lane16 even[3 * V], odd[3 * V];
  for (int v = 0; v < 3 * V; ++v) even[v] = odd[v] = Lane16{};
  for (int k = 0; k < 16 * V; k += 2, u += 96 * V) {
    for (int v = 0; v < 3 * V; ++v) even[v] += load16(u + 16 * v) * h[k];
    for (int v = 0; v < 3 * V; ++v) odd[v] += load16(u + 48 * V + 16 * v) * h[k + 1];
  }
  for (int v = 0; v < V; ++v) {
    // z = 1 / (1 + ez), r = 1 / (1 + er), c = (1 - ec) / (1 + ec); h' = (1 - z) c + z h with one division
    const Lane16 before = load16(h + 16 * v);
    const Lane16 ez = clamped_exp(-(load16(p + 16 * v) + even[v] + odd[v]));
    const Lane16 er = clamped_exp(-(load16(p + 16 * (V + v)) + even[V + v] + odd[V + v]));
    const Lane16 a = load16(p + 16 * (2 * V + v)) + (even[2 * V + v] + odd[2 * V + v]) / (er + 1.F);
    const Lane16 ec = clamped_exp(-2.F * a);
    store16(out + 16 * v, ((1.F - ec) * ez + (1.F + ec) * before) / ((1.F + ec) * (1.F + ez)));
  }
}

/// Of `rows` entries in each column, a multiple of 16.
void silu_in_place(Eigen::Ref<Tensor<float>> x) {
  for (Eigen::Index c = 0; c < x.cols(); ++c)
    for (Eigen::Index r = 0; r < x.rows(); r += 16) {
      float* at = x.col(c).data() + r;
      const Lane16 a = load16(at);
      store16(at, a / (clamped_exp(-a) + 1.F));
    }
}

void apply(const Linear<float>& layer, const Parameters<float>& weights, const TensorIn<float>& x,
           Eigen::Ref<Tensor<float>> y) {
  multiply<float>(weights[layer.weight()], weights[layer.bias()].data(), x, y);
}

}  // namespace

SweepsInference::SweepsInference(const Sweeps<float>& sweeps, const Parameters<float>& weights, int joints)
    : layers_(sweeps.layers()), weights_(weights) {
  const int h = sweeps.latent();
  switch (h) {
    case 16: step_ = gru_step<1>; break;
    case 32: step_ = gru_step<2>; break;
    case 48: step_ = gru_step<3>; break;
    case 64: step_ = gru_step<4>; break;
    default: throw std::invalid_argument("SweepsInference: latent size " + std::to_string(h));
  }
  states_.resize(3 * h, joints);
  gates_.resize(3 * h, joints);
  incoming_.resize(h, joints);
  hidden_.resize(h, joints);
}

void SweepsInference::run(const JointForest& forest, const TensorIn<float>& x, Eigen::Ref<Tensor<float>> y) {
  const Eigen::Index h = incoming_.rows();
  auto e = states_.topRows(h);
  apply(layers_.encode, weights_, x, e);
  silu_in_place(e);

  apply(layers_.to_up, weights_, e, gates_);
  const float* u = weights_[layers_.up.recurrent()].data();
  incoming_.setZero();
  for (int i = forest.size() - 1; i >= 0; --i) {
    float* state = states_.col(i).data() + h;
    step_(u, gates_.col(i).data(), incoming_.col(i).data(), state);
    const int parent = forest.parent[static_cast<std::size_t>(i)];
    if (parent >= 0) incoming_.col(parent) += Eigen::Map<const Eigen::VectorXf>(state, h);
  }

  apply(layers_.to_down, weights_, states_.topRows(2 * h), gates_);
  u = weights_[layers_.down.recurrent()].data();
  incoming_.col(0).setZero();  // what a root receives
  for (int i = 0; i < forest.size(); ++i) {
    const int parent = forest.parent[static_cast<std::size_t>(i)];
    const float* from = parent < 0 ? incoming_.col(0).data() : states_.col(parent).data() + 2 * h;
    step_(u, gates_.col(i).data(), from, states_.col(i).data() + 2 * h);
  }

  apply(layers_.decode.first(), weights_, states_.bottomRows(2 * h), hidden_);
  silu_in_place(hidden_);
  apply(layers_.decode.second(), weights_, hidden_, y);
}

}  // namespace rodsweep
