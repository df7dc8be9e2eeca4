#include "network/processor/coupled_inference.hpp"

#include <stdexcept>
#include <string>

#include "network/processor/lane16_blocks.hpp"

namespace rodsweep {
namespace {

using namespace lane16;

constexpr int triangle = CoupledFactors<float>::triangle;

/// C C^T from C's lower triangle by columns.
void square(const float* c, Lane16 (&n)[3]) {
  alignas(64) float column[6][16] = {}, row[6][8] = {};
  for (int j = 0; j < 6; ++j)
    for (int i = j; i < 6; ++i) column[j][i] = column[j][8 + i] = row[i][j] = *c++;
  Lane16 columns_of_c[6];
  for (int j = 0; j < 6; ++j) columns_of_c[j] = load16(column[j]);
  for (int q = 0; q < 3; ++q) n[q] = product(columns_of_c, load16(row[2 * q]));
}

}  // namespace

CoupledInference::CoupledInference(const CoupledFactors<float>& factors, const Parameters<float>& weights,
                                   const SystemPattern& pattern)
    : pattern_(pattern),
      joints_(pattern.joint.size()),
      couplings_(pattern.couplings.size()),
      h_(pattern.joint.size()),
      d_(pattern.joint.size()) {
  const int h = factors.latent();
  const auto n = static_cast<Eigen::Index>(joints_.size()), m = static_cast<Eigen::Index>(couplings_.size());
  if (!supports(h))
    throw std::invalid_argument("CoupledInference: latent size " + std::to_string(h) + "; must be a multiple of 16");
  const CoupledFactors<float>::Layers layers = factors.layers();
  message_ = NarrowMatrix(weights[layers.message.weight()]);
  message_bias_ = weights[layers.message.bias()];
  const auto encode = weights[layers.encode.weight()];
  Tensor<float> sums_first(h, 4 * h + triangle);
  sums_first << encode.rightCols(4 * h), encode.leftCols(triangle);
  encode_ = NarrowMatrix(sums_first);
  start_ =
      encode.middleCols(triangle, CoupledFactors<float>::coupling_features) * coupling_features(pattern.couplings, n);
  start_.colwise() += weights[layers.encode.bias()].col(0);
  join_ = NarrowMatrix(weights[layers.join.weight()]);
  join_bias_ = weights[layers.join.bias()];
  join_again_ = NarrowMatrix(weights[layers.join_again.weight()]);
  join_again_bias_ = weights[layers.join_again.bias()];
  Tensor<float> last = Tensor<float>::Zero(96, h);
  last.topRows(CoupledPasses<float>::size) = weights[layers.factors.weight()];
  last_ = NarrowMatrix(last);
  last_bias_.setZero(96);
  last_bias_.head(CoupledPasses<float>::size) = weights[layers.factors.bias()].col(0);
  for (std::size_t i = couplings_.size(); i-- > 0;) {
    Joint& row = joints_[at(pattern.couplings[i].row)];
    row.first_coupling = static_cast<int>(i);
    row.sides = std::max(row.sides, pattern.couplings[i].side + 1);
  }
  b_.setZero(36, m);
  x_.setZero(narrow_length(4 * h + triangle), n);
  e_.resize(3 * h, n);
  f_.resize(3 * h, n);
  g_.resize(h, n);
  messages_.resize(2 * h, m);
  before_.resize(h, n);
  sums_.resize(4 * h, n);
  factors_.resize(96, n);
}

void CoupledInference::factorise(const CanonicalFrames& frames, const BlockMatrix& a) {
  see(frames, a);
  message_.multiply(message_bias_.data(), b_, messages_);
  send_messages();
  encode_.multiply(nullptr, x_, before_);
  activate([&](Eigen::Index i) { return start_.col(i).data(); }, &e_);
  join_.multiply(nullptr, e_, before_);
  activate([&](Eigen::Index) { return join_bias_.data(); }, &f_);
  join_again_.multiply(nullptr, f_, before_);
  activate([&](Eigen::Index) { return join_again_bias_.data(); }, nullptr);
  last_.multiply(last_bias_.data(), g_, factors_);
  for (int i = 0; i < static_cast<int>(joints_.size()); ++i) form(i, frames);
}

/// Stores the couplings' blocks, and sets the features of all blocks.
void CoupledInference::see(const CanonicalFrames& frames, const BlockMatrix& a) {
  float entries[38], lower[triangle];
  for (std::size_t i = 0; i < couplings_.size(); ++i) {
    const SystemPattern::Coupling& c = pattern_.couplings[i];
    Coupling& coupling = couplings_[i];
    narrowed(a.blocks[at(c.block)], coupling.b);
    transpose(coupling.b, coupling.b_transposed);
    Lane16 seen[3] = {coupling.b[0], coupling.b[1], coupling.b[2]};
    ScaledFrame(frames, c.row).see(ScaledFrame(frames, c.column), seen);
    put_columns(seen, entries);
    narrow(entries, 36, b_.col(static_cast<Eigen::Index>(i)).data());
  }
  const Eigen::Index h = before_.rows();
  for (int k = 0; k < static_cast<int>(joints_.size()); ++k) {
    Lane16 seen[3];
    narrowed(a.blocks[at(pattern_.diagonal[at(k)])], seen);
    const ScaledFrame frame(frames, k);
    frame.see(frame, seen);
    put_columns(seen, entries);
    for (int c = 0, to = 0; c < 6; ++c)
      for (int r = c; r < 6; ++r) lower[to++] = entries[6 * c + r] - (r == c ? 1.F : 0.F);
    narrow(lower, triangle, x_.col(k).data() + 4 * h);
  }
}

void CoupledInference::send_messages() {
  const Eigen::Index h = before_.rows();
  sums_.setZero();
  for (std::size_t i = 0; i < couplings_.size(); ++i) {
    const SystemPattern::Coupling& c = pattern_.couplings[i];
    const float* from = messages_.col(static_cast<Eigen::Index>(i)).data();
    float* to_row = sums_.col(c.row).data() + h * c.side;
    float* to_column = sums_.col(c.column).data() + h * (2 + c.column_side);
    for (Eigen::Index r = 0; r < h; r += lane_floats) {
      store_lane(to_row + r, load_lane(to_row + r) + ramp(load_lane(from + r)));
      store_lane(to_column + r, load_lane(to_column + r) + ramp(load_lane(from + h + r)));
    }
  }
  for (Eigen::Index k = 0; k < x_.cols(); ++k)
    for (Eigen::Index r = 0; r < 4 * h; r += lane_floats)
      store_narrow(x_.col(k).data() + r, load_lane(sums_.col(k).data() + r));
}

/// Writes a layer's activations and, below them, their sums over later places per side; if `out` is null, only
/// activations, to g_.
template <class Start>
void CoupledInference::activate(const Start& start, NarrowColumns* out) {
  const Eigen::Index h = before_.rows();
  for (Eigen::Index k = 0; k < before_.cols(); ++k)
    for (Eigen::Index r = 0; r < h; r += lane_floats) {
      float* at_place = before_.col(k).data() + r;
      const FloatLane value = ramp(load_lane(at_place) + load_lane(start(k) + r));
      store_lane(at_place, value);
      store_narrow((out ? out->col(k).data() : g_.col(k).data()) + r, value);
    }
  if (!out) return;
  sums_.topRows(2 * h).setZero();
  for (const SystemPattern::Coupling& c : pattern_.couplings) {
    float* to = sums_.col(c.column).data() + h * c.column_side;
    const float* from = before_.col(c.row).data();
    for (Eigen::Index r = 0; r < h; r += lane_floats) store_lane(to + r, load_lane(to + r) + load_lane(from + r));
  }
  for (Eigen::Index k = 0; k < before_.cols(); ++k)
    for (Eigen::Index r = 0; r < 2 * h; r += lane_floats)
      store_narrow(out->col(k).data() + h + r, load_lane(sums_.col(k).data() + r));
}

void CoupledInference::form(int place, const CanonicalFrames& frames) {
  Joint& joint = joints_[at(place)];
  const ScaledFrame frame(frames, place);
  const float* from = factors_.col(place).data();
  square(from, joint.n);
  frame.around(joint.n);
  for (int side = 0; side < joint.sides; ++side) {
    take_columns(from + triangle + 36 * side, joint.t[side]);
    frame.around(joint.t[side]);
    transpose(joint.t[side], joint.t_transposed[side]);
  }
}

int CoupledInference::end_of(int place) const {
  std::size_t end = at(joints_[at(place)].first_coupling);
  while (end < couplings_.size() && pattern_.couplings[end].row == place) ++end;
  return static_cast<int>(end);
}

void CoupledInference::solve(const VectorX& r, VectorX& d) {
  const int n = static_cast<int>(joints_.size());
  for (int k = 0; k < n; ++k) h_[at(k)] = twice(load6(r.data() + 6 * pattern_.joint[at(k)]));
  for (int k = n - 1; k >= 0; --k) {
    const Joint& joint = joints_[at(k)];
    if (joint.sides == 0) continue;
    Lane16 w[2] = {times(joint.t_transposed[0], h_[at(k)]), {}};
    if (joint.sides > 1) w[1] = times(joint.t_transposed[1], h_[at(k)]);
    for (int i = joint.first_coupling, end = end_of(k); i < end; ++i) {
      const SystemPattern::Coupling& c = pattern_.couplings[at(i)];
      h_[at(c.column)] -= times(couplings_[at(i)].b_transposed, w[c.side]);
    }
  }
  for (int k = 0; k < n; ++k) {
    const Joint& joint = joints_[at(k)];
    Lane16& out = d_[at(k)];
    out = times(joint.n, h_[at(k)]);
    if (joint.sides > 0) {
      Lane16 v[2] = {};
      for (int i = joint.first_coupling, end = end_of(k); i < end; ++i) {
        const SystemPattern::Coupling& c = pattern_.couplings[at(i)];
        v[c.side] += times(couplings_[at(i)].b, d_[at(c.column)]);
      }
      out -= times(joint.t[0], v[0]);
      if (joint.sides > 1) out -= times(joint.t[1], v[1]);
    }
    const Lane8Float half = __builtin_shufflevector(out, out, 0, 1, 2, 3, 4, 5, 6, 7);
    store6(d.data() + 6 * pattern_.joint[at(k)], __builtin_convertvector(half, Lane8));
  }
}

}  // namespace rodsweep
