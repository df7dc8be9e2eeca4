#include "network/encoding/canonical_encoding.hpp"

#include <cstring>

namespace rodsweep {
namespace {

using FloatLane8 = float __attribute__((vector_size(32)));

float entry(const FloatLane8& values, int i) { return reinterpret_cast<const float*>(&values)[i]; }

FloatLane8 narrowed(const Lane8& values) { return __builtin_convertvector(values, FloatLane8); }

/// S T of a joint, in single precision: what features keep.
struct ScaledFrame {
  FloatLane8 along, across;

  ScaledFrame(const CanonicalFrames& frames, int place)
      : along(narrowed(frames.scale(place) * frames.frame(place).along)),
        across(narrowed(frames.scale(place) * frames.frame(place).across)) {}

  FloatLane8 operator()(const FloatLane8& v) const {
    return along * v + across * __builtin_shufflevector(v, v, 1, 0, 2, 4, 3, 5, 6, 7);
  }
};

/// Columns first to 5 of S_row T_row block T_column^T S_column.
template <int first>
void see(const Block6& block, const ScaledFrame& row, const ScaledFrame& column, FloatLane8 (&out)[6]) {
  FloatLane8 half[6];
#pragma GCC unroll 6
  for (int c = 0; c < 6; ++c) half[c] = row(narrowed(block.column[c]));
  constexpr int other[6] = {1, 0, 2, 4, 3, 5};
#pragma GCC unroll 6
  for (int c = first; c < 6; ++c)
    out[c] = c == 2 || c == 5 ? entry(column.along, c) * half[c]
                              : entry(column.along, c) * half[c] + entry(column.across, c) * half[other[c]];
}

/// `count` entries of a column.
template <int count>
float* put(float* to, const FloatLane8& values) {
  std::memcpy(to, &values, count * sizeof(float));
  return to + count;
}

}  // namespace

void CanonicalEncoding::encode(const SystemPattern& pattern, const BlockMatrix& a, const VectorX& residual,
                               Eigen::Ref<Tensor<float>> features) {
  const auto at = [](int index) { return static_cast<std::size_t>(index); };
  frames_.find(pattern, a, residual);
  const double inverse_rho = frames_.rho() > 0 ? 1 / frames_.rho() : 0;
  FloatLane8 seen[6];
  for (int i = 0; i < static_cast<int>(pattern.joint.size()); ++i) {
    const ScaledFrame frame(frames_, i);
    float* out = features.col(i).data();
    out = put<6>(out, frame(narrowed(inverse_rho * load6(residual.data() + 6 * pattern.joint[at(i)]))));
    see<1>(a.blocks[at(pattern.diagonal[at(i)])], frame, frame, seen);
    out = put<1>(out, seen[1]);
    out = put<2>(out, seen[2]);
    out = put<3>(out, seen[3]);
    out = put<4>(out, seen[4]);
    out = put<5>(out, seen[5]);
    const int k = pattern.to_parent[at(i)];
    if (k < 0) {
      std::fill(out, out + 36, 0.F);
      continue;
    }
    const SystemPattern::Coupling& coupling = pattern.couplings[at(k)];
    see<0>(a.blocks[at(coupling.block)], frame, ScaledFrame(frames_, coupling.column), seen);
    for (const FloatLane8& column : seen) out = put<6>(out, column);
  }
}

Lane8 CanonicalEncoding::from_unit(int place, const Lane8& answer) const {
  return frames_.rho() * frames_.scale(place) * frames_.frame(place).back(answer);
}

Lane8 CanonicalEncoding::to_unit(int place, const Lane8& correction) const {
  const Lane8 inverse =
      Lane8{1, 1, 1, 1, 1, 1, 0, 0} / (frames_.rho() * frames_.scale(place) + Lane8{0, 0, 0, 0, 0, 0, 1, 1});
  return frames_.frame(place)(correction * inverse);
}

}  // namespace rodsweep
