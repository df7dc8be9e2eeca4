#include "network/encoding/scaled_system.hpp"

#include <algorithm>

namespace rodsweep {
namespace {

template <class T>
using Block = Eigen::Map<const Eigen::Matrix<T, 6, 6>>;

/// Joints on the same segment are all coupled with each other.
void put_sides(const std::vector<int>& place, const BlockMatrix& a, SystemPattern& pattern) {
  std::vector<int> earliest(pattern.joint.size());  // the earliest joint that is coupled with each place's joint
  for (std::size_t i = 0; i < earliest.size(); ++i) {
    earliest[i] = -1;
    for (int k = a.row_begin(pattern.joint[i]); k < a.row_end(pattern.joint[i]); ++k)
      if (const int joint = a.column(k);
          joint != pattern.joint[i] && (earliest[i] < 0 || place[at(joint)] < place[at(earliest[i])]))
        earliest[i] = joint;
  }
  const auto side = [&](int of, int other) {
    const int joint = pattern.joint[at(other)];
    return joint == earliest[at(of)] || a.find(earliest[at(of)], joint) >= 0 ? 0 : 1;
  };
  for (SystemPattern::Coupling& c : pattern.couplings) {
    c.side = side(c.row, c.column);
    c.column_side = side(c.column, c.row);
  }
}

}  // namespace

SystemPattern system_pattern(const JointForest& forest, const BlockMatrix& a) {
  SystemPattern out;
  out.joint = forest.order;
  std::vector<int> place(forest.order.size());
  for (int i = 0; i < forest.size(); ++i) place[at(forest.order[at(i)])] = i;
  for (int i = 0; i < forest.size(); ++i) {
    const int row = forest.order[at(i)];
    out.diagonal.push_back(a.diagonal(row));
    out.to_parent.push_back(-1);
    for (int k = a.row_begin(row); k < a.row_end(row); ++k) {
      const int column = place[at(a.column(k))];
      if (column >= i) continue;
      if (column == forest.parent[at(i)]) out.to_parent.back() = static_cast<int>(out.couplings.size());
      out.couplings.push_back({i, column, k});
    }
  }
  put_sides(place, a, out);
  return out;
}

double correction_scale(const BlockMatrix& a, const VectorX& residual, VectorX& scale) {
  inverse_root_diagonal(a, scale);
  const double rho = std::sqrt(scale.cwiseProduct(residual).squaredNorm() / a.unknowns());
  scale *= rho;
  return rho;
}

ScaledSystem<float> scaled_system(const SystemPattern& pattern, const BlockMatrix& a, const VectorX& residual,
                                  const VectorX& error, double unit_energy) {
  VectorX s(a.unknowns());
  inverse_root_diagonal(a, s);
  const VectorX scaled = s.cwiseProduct(residual);
  const double rho2 = scaled.squaredNorm() / a.unknowns(), inverse_rho = rho2 > 0 ? 1 / std::sqrt(rho2) : 0;
  const auto scale = [&](int place) -> const double* { return &s[6 * pattern.joint[at(place)]]; };
  return scaled_system_of(
      pattern, a, std::sqrt(rho2), error.dot(residual), unit_energy,
      [&](int place, float* out) {
        Eigen::Map<Eigen::Matrix<float, 6, 1>> to(out);
        to = (scaled.segment<6>(6 * pattern.joint[at(place)]) * inverse_rho).cast<float>();
      },
      [&](const Block6& block, int row, int column, float* out) {
        write_scaled(block, scale(row), scale(column), out);
      });
}

template <class T>
ScaledSystem<T> side_by_side(const std::vector<const ScaledSystem<float>*>& systems) {
  Eigen::Index places = 0, couplings = 0;
  for (const ScaledSystem<float>* one : systems) {
    places += one->diagonal.cols();
    couplings += one->coupling.cols();
  }
  ScaledSystem<T> out;
  out.diagonal.resize(36, places);
  out.coupling.resize(36, couplings);
  out.residual.resize(6, places);
  out.couplings.reserve(static_cast<std::size_t>(couplings));
  out.first_place = {0};
  Eigen::Index place = 0, coupling = 0;
  for (const ScaledSystem<float>* one : systems) {
    out.diagonal.middleCols(place, one->diagonal.cols()) = one->diagonal.cast<T>();
    out.residual.middleCols(place, one->diagonal.cols()) = one->residual.cast<T>();
    out.coupling.middleCols(coupling, one->coupling.cols()) = one->coupling.cast<T>();
    for (SystemPattern::Coupling c : one->couplings) {
      c.row += static_cast<int>(place);
      c.column += static_cast<int>(place);
      c.block += static_cast<int>(coupling);
      out.couplings.push_back(c);
    }
    place += one->diagonal.cols();
    coupling += one->coupling.cols();
    out.first_place.push_back(static_cast<int>(place));
    out.base_energy.insert(out.base_energy.end(), one->base_energy.begin(), one->base_energy.end());
    out.unit_energy.insert(out.unit_energy.end(), one->unit_energy.begin(), one->unit_energy.end());
  }
  return out;
}

template <class T>
void multiply(const ScaledSystem<T>& a, const TensorIn<T>& x, Eigen::Ref<Tensor<T>> y) {
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    y.col(i).noalias() = Block<T>(a.diagonal.col(i).data()) * x.col(i).template head<6>();
  for (const SystemPattern::Coupling& c : a.couplings) {
    const Block<T> block(a.coupling.col(c.block).data());
    y.col(c.row).noalias() += block * x.col(c.column).template head<6>();
    y.col(c.column).noalias() += block.transpose() * x.col(c.row).template head<6>();
  }
}

template ScaledSystem<float> side_by_side<float>(const std::vector<const ScaledSystem<float>*>&);
template ScaledSystem<double> side_by_side<double>(const std::vector<const ScaledSystem<float>*>&);
template void multiply<float>(const ScaledSystem<float>&, const TensorIn<float>&, Eigen::Ref<Tensor<float>>);
template void multiply<double>(const ScaledSystem<double>&, const TensorIn<double>&, Eigen::Ref<Tensor<double>>);

}  // namespace rodsweep
