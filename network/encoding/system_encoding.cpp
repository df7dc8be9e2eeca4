#include "network/encoding/system_encoding.hpp"

namespace rodsweep {

void SystemEncoding::encode(const BlockMatrix& a, const VectorX& residual, Eigen::Ref<Tensor<float>> features,
                            VectorX& scale) const {
  const auto at = [](int index) { return static_cast<std::size_t>(index); };
  const double rho = correction_scale(a, residual, scale);
  const double inverse_rho2 = rho > 0 ? 1 / (rho * rho) : 0;  // products of two entries of `scale` carry rho^2
  for (int i = 0; i < static_cast<int>(pattern_.joint.size()); ++i) {
    const int joint = pattern_.joint[at(i)];
    const double* s = &scale[6 * joint];
    float* out = features.col(i).data();
    for (int r = 0; r < 6; ++r) *out++ = static_cast<float>(residual[6 * joint + r] * s[r] * inverse_rho2);
    const Block6& diagonal = a.blocks[at(pattern_.diagonal[at(i)])];
    for (int c = 0; c < 6; ++c)
      for (int r = 0; r < c; ++r) *out++ = static_cast<float>(diagonal.column[c][r] * s[r] * s[c] * inverse_rho2);
    const int k = pattern_.to_parent[at(i)];
    if (k < 0) {
      std::fill(out, out + 36, 0.F);
      continue;
    }
    const SystemPattern::Coupling& up = pattern_.couplings[at(k)];
    const Block6& block = a.blocks[at(up.block)];
    const double* parent = &scale[6 * pattern_.joint[at(up.column)]];
    for (int c = 0; c < 6; ++c)
      for (int r = 0; r < 6; ++r) *out++ = static_cast<float>(block.column[c][r] * s[r] * parent[c] * inverse_rho2);
  }
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
