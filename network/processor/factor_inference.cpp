#include "network/processor/factor_inference.hpp"

#include <cstring>
#include <stdexcept>
#include <string>

#include "network/layers/float_lanes.hpp"

namespace rodsweep {
namespace {

using Lane16 = float __attribute__((vector_size(64)));

std::size_t at(int index) { return static_cast<std::size_t>(index); }

Lane16 load16(const float* from) {
  Lane16 out;
  std::memcpy(&out, from, sizeof out);
  return out;
}

/// Both halves of a register: lane I of `v`, and lane J.
template <int I, int J>
Lane16 spread(const Lane16& v) {
  return __builtin_shufflevector(v, v, I, I, I, I, I, I, I, I, J, J, J, J, J, J, J, J);
}

/// A v, twice; v in lanes 0..5.
Lane16 times(const Lane16 (&a)[3], const Lane16& v) {
  const Lane16 sum = a[0] * spread<0, 1>(v) + a[1] * spread<2, 3>(v) + a[2] * spread<4, 5>(v);
  return sum + __builtin_shufflevector(sum, sum, 8, 9, 10, 11, 12, 13, 14, 15, 0, 1, 2, 3, 4, 5, 6, 7);
}

/// Columns I and J of a symmetric matrix whose lower triangle, by columns, is in lanes 0..15 of `first` and in those of
/// `last` from Rest - 16 on.
template <int I, int J, int Rest>
Lane16 columns(const Lane16& first, const Lane16& last) {
  // Entry (r, c), r >= c, is number c (11 - c) / 2 + r of the triangle.
#define RODSWEEP_ENTRY(r, c)                                                                                     \
  ((r) >= (c)                                                                                                    \
       ? ((c) * (11 - (c)) / 2 + (r) < 16 ? (c) * (11 - (c)) / 2 + (r) : (c) * (11 - (c)) / 2 + (r) + Rest - 16) \
       : ((r) * (11 - (r)) / 2 + (c) < 16 ? (r) * (11 - (r)) / 2 + (c) : (r) * (11 - (r)) / 2 + (c) + Rest - 16))
#define RODSWEEP_COLUMN(c)                                                                                      \
  RODSWEEP_ENTRY(0, c), RODSWEEP_ENTRY(1, c), RODSWEEP_ENTRY(2, c), RODSWEEP_ENTRY(3, c), RODSWEEP_ENTRY(4, c), \
      RODSWEEP_ENTRY(5, c), 0, 0
  return __builtin_shufflevector(first, last, RODSWEEP_COLUMN(I), RODSWEEP_COLUMN(J));
#undef RODSWEEP_COLUMN
#undef RODSWEEP_ENTRY
}

/// Two columns of T B: `t` T's columns, each in both halves; B's columns begin at lanes C and D of `b`.
template <int C, int D>
Lane16 product(const Lane16 (&t)[6], const Lane16& b) {
  return (t[0] * spread<C, D>(b) + t[1] * spread<C + 1, D + 1>(b)) +
         (t[2] * spread<C + 2, D + 2>(b) + t[3] * spread<C + 3, D + 3>(b)) +
         (t[4] * spread<C + 4, D + 4>(b) + t[5] * spread<C + 5, D + 5>(b));
}

/// Rows R and R + 1 of a matrix given by pairs of columns.
template <int R>
Lane16 rows(const Lane16 (&m)[3]) {
  constexpr int S = R + 1;
  const Lane16 four =
      __builtin_shufflevector(m[0], m[1], R, 8 + R, 16 + R, 24 + R, 0, 0, 0, 0, S, 8 + S, 16 + S, 24 + S, 0, 0, 0, 0);
  return __builtin_shufflevector(four, m[2], 0, 1, 2, 3, 16 + R, 24 + R, 0, 0, 8, 9, 10, 11, 16 + S, 24 + S, 0, 0);
}

FloatLane larger(const FloatLane& a, float b) { return a > b ? a : broadcast_lane(b); }

/// ramp(a) (network/layers/ramp.hpp).
FloatLane ramp(const FloatLane& a) {
  const FloatLane t = larger(a, -1) * 0.5F + 0.5F, half = t < 1.F ? t : broadcast_lane(1);
  return half * half + larger(a - 1.F, 0);
}

}  // namespace

FactorInference::FactorInference(const FactorSweeps<float>& sweeps, const Parameters<float>& weights,
                                 const JointForest& forest)
    : forest_(forest), joints_(at(forest.size())), h_(at(forest.size())), y_(at(forest.size())) {
  using Sweep = FactorSweeps<float>;
  const int h = sweeps.latent(), n = forest.size();
  if (!supports(h)) throw std::invalid_argument("FactorInference: latent size " + std::to_string(h));
  const Sweep::Layers layers = sweeps.layers();
  const auto encode = weights[layers.encode.weight()];
  encode_ = NarrowMatrix(encode.leftCols(Sweep::block_features));
  start_ = encode.rightCols(Sweep::place_features) * place_features(forest);
  start_.colwise() += weights[layers.encode.bias()].col(0);
  join_ = NarrowMatrix(weights[layers.join.weight()]);
  join_bias_ = weights[layers.join.bias()];
  join_again_ = NarrowMatrix(weights[layers.join_again.weight()]);
  join_again_bias_ = weights[layers.join_again.bias()];
  Tensor<float> last = Tensor<float>::Zero(48, h);
  last_bias_.setZero(48);
  for (int i = 0; i < 2 * Sweep::triangle; ++i) {
    const int entry = i % Sweep::triangle;
    const bool of_t = i >= Sweep::triangle;
    const int row = entry < 16 ? (of_t ? 32 : 0) + entry : (of_t ? 21 : 16) + entry - 16;
    last.row(row) = weights[layers.factors.weight()].row(i);
    last_bias_[row] = weights[layers.factors.bias()](i, 0);
  }
  last_ = NarrowMatrix(last);
  a_.setZero(narrow_length(Sweep::block_features), n);
  e_.resize(2 * h, n);
  f_.resize(2 * h, n);
  g_.resize(h, n);
  before_.resize(h, n);
  sums_.resize(h, n);
  factors_.resize(48, n);
}

void FactorInference::factorise(const TensorIn<float>& x) {
  using Sweep = FactorSweeps<float>;
  const Eigen::Index h = g_.rows();
  const int n = forest_.size();
  /// The activations of a layer, and below them the sums of the children's.
  const auto activate = [&](const auto& start, NarrowColumns& out) {
    sums_.setZero();
    for (int i = n - 1; i >= 0; --i) {
      const int parent = forest_.parent[at(i)];
      const float *from = before_.col(i).data(), *begin = start(i), *children = sums_.col(i).data();
      for (Eigen::Index r = 0; r < h; r += lane_floats) {
        const FloatLane value = ramp(load_lane(from + r) + load_lane(begin + r));
        store_narrow(out.col(i).data() + r, value);
        store_narrow(out.col(i).data() + h + r, load_lane(children + r));
        if (parent < 0) continue;
        float* to = sums_.col(parent).data() + r;
        store_lane(to, load_lane(to) + value);
      }
    }
  };
  for (int i = 0; i < n; ++i)
    narrow(x.col(i).data() + Sweep::residual_features, Sweep::block_features, a_.col(i).data());
  encode_.multiply(nullptr, a_, before_);
  activate([&](int i) { return start_.col(i).data(); }, e_);
  join_.multiply(nullptr, e_, before_);
  activate([&](int) { return join_bias_.data(); }, f_);
  join_again_.multiply(join_again_bias_.data(), f_, before_);
  for (int i = 0; i < n; ++i)
    for (Eigen::Index r = 0; r < h; r += lane_floats)
      store_narrow(g_.col(i).data() + r, ramp(load_lane(before_.col(i).data() + r)));
  last_.multiply(last_bias_.data(), g_, factors_);
  for (int i = 0; i < n; ++i) form(i, x.col(i).data() + Sweep::coupling);
}

void FactorInference::form(int place, const float* coupling) {
  Joint& joint = joints_[at(place)];
  const float* triangles = factors_.col(place).data();
  const Lane16 n = load16(triangles), rest = load16(triangles + 16);
  joint.n[0] = columns<0, 1, 16>(n, rest);
  joint.n[1] = columns<2, 3, 16>(n, rest);
  joint.n[2] = columns<4, 5, 16>(n, rest);
  if (forest_.parent[at(place)] < 0) return;
  const Lane16 t = load16(triangles + 32);
  const Lane16 twice[6] = {columns<0, 0, 21>(t, rest), columns<1, 1, 21>(t, rest), columns<2, 2, 21>(t, rest),
                           columns<3, 3, 21>(t, rest), columns<4, 4, 21>(t, rest), columns<5, 5, 21>(t, rest)};
  joint.m[0] = product<0, 6>(twice, load16(coupling));
  joint.m[1] = product<0, 6>(twice, load16(coupling + 12));
  joint.m[2] = product<4, 10>(twice, load16(coupling + 20));  // not beyond the block
  joint.m_transposed[0] = rows<0>(joint.m);
  joint.m_transposed[1] = rows<2>(joint.m);
  joint.m_transposed[2] = rows<4>(joint.m);
}

void FactorInference::solve(const TensorIn<float>& r, Eigen::Ref<Tensor<float>> y) {
  const int n = forest_.size();
  for (int i = 0; i < n; ++i) {
    h_[at(i)] = Lane16{};
    std::memcpy(&h_[at(i)], r.col(i).data(), 6 * sizeof(float));
  }
  for (int i = n - 1; i >= 0; --i)
    if (const int parent = forest_.parent[at(i)]; parent >= 0)
      h_[at(parent)] -= times(joints_[at(i)].m_transposed, h_[at(i)]);
  for (int i = 0; i < n; ++i) {
    const Joint& joint = joints_[at(i)];
    const int parent = forest_.parent[at(i)];
    Lane16& out = y_[at(i)];
    out = times(joint.n, h_[at(i)]);
    if (parent >= 0) out -= times(joint.m, y_[at(parent)]);
    std::memcpy(y.col(i).data(), &out, 6 * sizeof(float));
  }
}

}  // namespace rodsweep
