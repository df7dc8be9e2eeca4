#include "network/processor/factor_inference.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <stdexcept>
#include <string>

#include "network/processor/lane16_blocks.hpp"

namespace rodsweep {
namespace {

using namespace lane16;

/// Replaces a symmetric matrix, its lower triangle by columns, by the one with the magnitudes of its eigenvalues, at
/// least a thousandth of the largest, unless it is positive definite.
void make_positive(float* triangle) {
  using Matrix6f = Eigen::Matrix<float, 6, 6>;
  Matrix6f n;
  const float* from = triangle;
  for (int c = 0; c < 6; ++c)
    for (int r = c; r < 6; ++r) n(r, c) = *from++;
  if (!Eigen::Map<const Eigen::Matrix<float, 21, 1>>(triangle).allFinite()) return;
  if (n.selfadjointView<Eigen::Lower>().llt().info() == Eigen::Success) return;
  const Eigen::SelfAdjointEigenSolver<Matrix6f> of(n);  // reads the lower triangle
  Eigen::Matrix<float, 6, 1> magnitudes = of.eigenvalues().cwiseAbs();
  magnitudes = magnitudes.cwiseMax(1e-3F * magnitudes.maxCoeff());
  n = of.eigenvectors() * magnitudes.asDiagonal() * of.eigenvectors().transpose();
  for (int c = 0; c < 6; ++c)
    for (int r = c; r < 6; ++r) *triangle++ = n(r, c);
}

}  // namespace

FactorInference::FactorInference(const FactorSweeps<float>& sweeps, const Parameters<float>& weights,
                                 const JointForest& forest, const SystemPattern& pattern)
    : forest_(forest), pattern_(pattern), joints_(at(forest.size())), h_(at(forest.size())), d_(at(forest.size())) {
  using Sweep = FactorSweeps<float>;
  const int h = sweeps.latent(), n = forest.size();
  if (!supports(h))
    throw std::invalid_argument("FactorInference: latent size " + std::to_string(h) + "; must be a multiple of 16");
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

void FactorInference::factorise(const TensorIn<float>& x, const CanonicalFrames& frames, const BlockMatrix& a,
                                bool positive) {
  using Sweep = FactorSweeps<float>;
  const Eigen::Index h = g_.rows();
  const int n = forest_.size();
  /// Writes a layer's activations and, below them, the sums of the children's activations.
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
  if (positive)
    for (int i = 0; i < n; ++i) make_positive(factors_.col(i).data());
  for (int i = 0; i < n; ++i) form(i, frames, a);
}

void FactorInference::form(int place, const CanonicalFrames& frames, const BlockMatrix& a) {
  Joint& joint = joints_[at(place)];
  const ScaledFrame frame(frames, place);
  const float* triangles = factors_.col(place).data();
  const Lane16 n = load16(triangles), rest = load16(triangles + 16);
  joint.n[0] = columns<0, 1, 16>(n, rest);
  joint.n[1] = columns<2, 3, 16>(n, rest);
  joint.n[2] = columns<4, 5, 16>(n, rest);
  frame.around(joint.n);
  const int coupling = pattern_.to_parent[at(place)];
  if (coupling < 0) return;
  const Lane16 t = load16(triangles + 32);
  const Lane16 each[6] = {columns<0, 0, 21>(t, rest), columns<1, 1, 21>(t, rest), columns<2, 2, 21>(t, rest),
                          columns<3, 3, 21>(t, rest), columns<4, 4, 21>(t, rest), columns<5, 5, 21>(t, rest)};
  const Block6& block = a.blocks[at(pattern_.couplings[at(coupling)].block)];
  for (int q = 0; q < 3; ++q) {
    const Lane16 b = halves(__builtin_convertvector(block.column[2 * q], Lane8Float),
                            __builtin_convertvector(block.column[2 * q + 1], Lane8Float));
    joint.m[q] = frame.transposed(product(each, frame.apply(b)));
  }
  joint.m_transposed[0] = rows<0>(joint.m);
  joint.m_transposed[1] = rows<2>(joint.m);
  joint.m_transposed[2] = rows<4>(joint.m);
}

void FactorInference::solve(const VectorX& r, VectorX& d) {
  const int n = forest_.size();
  for (int i = 0; i < n; ++i) h_[at(i)] = twice(load6(r.data() + 6 * pattern_.joint[at(i)]));
  for (int i = n - 1; i >= 0; --i)
    if (const int parent = forest_.parent[at(i)]; parent >= 0)
      h_[at(parent)] -= times(joints_[at(i)].m_transposed, h_[at(i)]);
  for (int i = 0; i < n; ++i) {
    const Joint& joint = joints_[at(i)];
    const int parent = forest_.parent[at(i)];
    Lane16& out = d_[at(i)];
    out = times(joint.n, h_[at(i)]);
    if (parent >= 0) out -= times(joint.m, d_[at(parent)]);
    const Lane8Float half = __builtin_shufflevector(out, out, 0, 1, 2, 3, 4, 5, 6, 7);
    store6(d.data() + 6 * pattern_.joint[at(i)], __builtin_convertvector(half, Lane8));
  }
}

}  // namespace rodsweep
