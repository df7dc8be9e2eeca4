#include "network/processor/sweeps_inference.hpp"

#include <stdexcept>
#include <string>

#include "network/layers/float_lanes.hpp"
#include "network/layers/product.hpp"

namespace rodsweep {
namespace {

/// out = U h for `rows` of U's rows, in tiles that stay in registers.
template <int Rows, int H>
void recurrent_product(const float* u, const float* h, float* out) {
  constexpr int lanes = Rows / lane_floats, tile = lanes % 6 == 0 ? 6 : 3;
  for (int first = 0; first < lanes; first += tile) {
    // Two sets of sums, so that a multiplication need not wait for the one before.
    FloatLane even[tile], odd[tile];
    for (int t = 0; t < tile; ++t) even[t] = odd[t] = FloatLane{};
    const float* column = u + first * lane_floats;
    for (int k = 0; k < H; k += 2, column += 2 * Rows) {
      for (int t = 0; t < tile; ++t) even[t] += load_lane(column + t * lane_floats) * h[k];
      for (int t = 0; t < tile; ++t) odd[t] += load_lane(column + Rows + t * lane_floats) * h[k + 1];
    }
    for (int t = 0; t < tile; ++t) store_lane(out + (first + t) * lane_floats, even[t] + odd[t]);
  }
}

/// h' of one joint (network/layers/gru.hpp); u [3 H, H] column-major, p [3 H].
template <int H>
void gru_step(const float* u, const float* p, const float* h, float* out) {
  alignas(64) float uh[3 * H];
  recurrent_product<3 * H, H>(u, h, uh);
  for (int i = 0; i < H; i += lane_floats) {
    // z = 1 / (1 + ez), r = 1 / (1 + er), c = (1 - ec) / (1 + ec); h' = (1 - z) c + z h with one division
    const auto sum = [&](int gate) { return load_lane(p + gate * H + i) + load_lane(uh + gate * H + i); };
    const FloatLane ez = clamped_exp(-sum(0)), er = clamped_exp(-sum(1));
    const FloatLane ec = clamped_exp(-2.F * (load_lane(p + 2 * H + i) + load_lane(uh + 2 * H + i) / (er + 1.F)));
    store_lane(out + i, ((1.F - ec) * ez + (1.F + ec) * load_lane(h + i)) / ((1.F + ec) * (1.F + ez)));
  }
}

/// h' of one joint whose recurrence is linear: p has z and (1 - z) c.
template <int H>
void linear_step(const float*, const float* p, const float* h, float* out) {
  for (int i = 0; i < H; i += lane_floats)
    store_lane(out + i, load_lane(p + i) * load_lane(h + i) + load_lane(p + H + i));
}

/// P_z and P_c of all joints become z and (1 - z) c, where 1 - z = e / (1 + e), e = exp(-P_z).
void close_gates(Eigen::Ref<Tensor<float>> gates) {
  const Eigen::Index h = gates.rows() / 2;
  for (Eigen::Index k = 0; k < gates.cols(); ++k)
    for (Eigen::Index i = 0; i < h; i += lane_floats) {
      float *z = gates.col(k).data() + i, *c = z + h;
      const FloatLane e = clamped_exp(-load_lane(z)), open = 1.F / (1.F + e);
      store_lane(z, open);
      store_lane(c, e * open * load_lane(c));
    }
}

/// Columns are multiples of 16 entries long.
void silu_in_place(Eigen::Ref<Tensor<float>> x) {
  for (Eigen::Index c = 0; c < x.cols(); ++c)
    for (Eigen::Index r = 0; r < x.rows(); r += lane_floats) {
      float* at = x.col(c).data() + r;
      const FloatLane a = load_lane(at);
      store_lane(at, a / (clamped_exp(-a) + 1.F));
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
  const bool gated = sweeps.recurrence() == Recurrence::gated;
  switch (h) {
    case 16: step_ = gated ? gru_step<16> : linear_step<16>; break;
    case 32: step_ = gated ? gru_step<32> : linear_step<32>; break;
    case 48: step_ = gated ? gru_step<48> : linear_step<48>; break;
    case 64: step_ = gated ? gru_step<64> : linear_step<64>; break;
    default: throw std::invalid_argument("SweepsInference: latent size " + std::to_string(h));
  }
  states_.resize(3 * h, joints);
  gates_.resize((gated ? 3 : LinearRecurrence<float>::gates) * h, joints);
  linear_ = !gated;
  incoming_.resize(h, joints);
  hidden_.resize(h, joints);
}

void SweepsInference::run(const JointForest& forest, const TensorIn<float>& x, Eigen::Ref<Tensor<float>> y) {
  const Eigen::Index h = incoming_.rows();
  auto e = states_.topRows(h);
  apply(layers_.encode, weights_, x, e);
  silu_in_place(e);

  apply(layers_.to_up, weights_, e, gates_);
  const auto recurrent = [this](const Gru<float>& gru) { return linear_ ? nullptr : weights_[gru.recurrent()].data(); };
  if (linear_) close_gates(gates_);
  const float* u = recurrent(layers_.up);
  incoming_.setZero();
  for (int i = forest.size() - 1; i >= 0; --i) {
    float* state = states_.col(i).data() + h;
    step_(u, gates_.col(i).data(), incoming_.col(i).data(), state);
    const int parent = forest.parent[static_cast<std::size_t>(i)];
    if (parent >= 0) incoming_.col(parent) += Eigen::Map<const Eigen::VectorXf>(state, h);
  }

  apply(layers_.to_down, weights_, states_.topRows(2 * h), gates_);
  if (linear_) close_gates(gates_);
  u = recurrent(layers_.down);
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
