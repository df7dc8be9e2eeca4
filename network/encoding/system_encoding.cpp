#include "network/encoding/system_encoding.hpp"

#include <cstring>

namespace rodsweep {
namespace {

using FloatLane8 = float __attribute__((vector_size(32)));

float entry(const FloatLane8& values, int i) { return reinterpret_cast<const float*>(&values)[i]; }

FloatLane8 narrowed(const Lane8& values) { return __builtin_convertvector(values, FloatLane8); }

/// S T of a joint, in the single precision of features.
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

/// Writes the first `count` entries of a column.
template <int count>
float* put(float* to, const FloatLane8& values) {
  std::memcpy(to, &values, count * sizeof(float));
  return to + count;
}

}  // namespace

void SystemEncoding::encode(const SystemPattern& pattern, const BlockMatrix& a, const VectorX& residual,
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
    const SystemPattern::Coupling& to_parent = pattern.couplings[at(k)];
    see<0>(a.blocks[at(to_parent.block)], frame, ScaledFrame(frames_, to_parent.column), seen);
    for (const FloatLane8& column : seen) out = put<6>(out, column);
  }
}

Lane8 SystemEncoding::from_unit(int place, const Lane8& answer) const {
  return frames_.rho() * frames_.scale(place) * frames_.frame(place).back(answer);
}

Lane8 SystemEncoding::to_unit(int place, const Lane8& correction) const {
  const Lane8 inverse =
      Lane8{1, 1, 1, 1, 1, 1, 0, 0} / (frames_.rho() * frames_.scale(place) + Lane8{0, 0, 0, 0, 0, 0, 1, 1});
  return frames_.frame(place)(correction * inverse);
}

template <class T>
Tensor<T> system_features(const ScaledSystem<T>& systems, const JointForest& forest) {
  std::vector<int> parent(forest.order.size());
  for (std::size_t i = 0; i < parent.size(); ++i)
    parent[static_cast<std::size_t>(forest.order[i])] =
        forest.parent[i] < 0 ? -1 : forest.order[static_cast<std::size_t>(forest.parent[i])];
  Tensor<T> out = Tensor<T>::Zero(SystemEncoding::size, systems.diagonal.cols());
  out.template topRows<6>() = systems.residual;
  Eigen::Index row = 6;
  for (int c = 1; c < 6; row += c, ++c) out.middleRows(row, c) = systems.diagonal.middleRows(6 * c, c);
  for (const SystemPattern::Coupling& c : systems.couplings)
    if (parent[static_cast<std::size_t>(c.row)] == c.column)
      out.col(c.row).template tail<36>() = systems.coupling.col(c.block);
  return out;
}

template Tensor<float> system_features<float>(const ScaledSystem<float>&, const JointForest&);
template Tensor<double> system_features<double>(const ScaledSystem<double>&, const JointForest&);

}  // namespace rodsweep
