#include "network/encoding/canonical_encoding.hpp"

#include <cstring>

namespace rodsweep {
namespace {

using FloatLane8 = float __attribute__((vector_size(32)));

/// `count` entries of a column.
template <int count>
float* put(float* to, const Lane8& values) {
  const FloatLane8 narrow = __builtin_convertvector(values, FloatLane8);
  std::memcpy(to, &narrow, count * sizeof(float));
  return to + count;
}

}  // namespace

void CanonicalEncoding::encode(const SystemPattern& pattern, const BlockMatrix& a, const VectorX& residual,
                               Eigen::Ref<Tensor<float>> features) {
  const auto at = [](int index) { return static_cast<std::size_t>(index); };
  frames_.find(pattern, a, residual);
  const double inverse_rho = frames_.rho() > 0 ? 1 / frames_.rho() : 0;
  for (int i = 0; i < static_cast<int>(pattern.joint.size()); ++i) {
    const CanonicalFrame& frame = frames_.frame(i);
    const Lane8& scale = frames_.scale(i);
    float* out = features.col(i).data();
    out = put<6>(out, inverse_rho * scale * frame(load6(residual.data() + 6 * pattern.joint[at(i)])));
    const Block6 diagonal = seen(a.blocks[at(pattern.diagonal[at(i)])], frame, frame);
    const auto column = [&](int c) { return diagonal.column[c] * scale * scale[c]; };
    out = put<1>(out, column(1));
    out = put<2>(out, column(2));
    out = put<3>(out, column(3));
    out = put<4>(out, column(4));
    out = put<5>(out, column(5));
    const int k = pattern.to_parent[at(i)];
    if (k < 0) {
      std::fill(out, out + 36, 0.F);
      continue;
    }
    const SystemPattern::Coupling& coupling = pattern.couplings[at(k)];
    const Block6 block = seen(a.blocks[at(coupling.block)], frame, frames_.frame(coupling.column));
    const Lane8& parent = frames_.scale(coupling.column);
    for (int c = 0; c < 6; ++c) out = put<6>(out, block.column[c] * scale * parent[c]);
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
