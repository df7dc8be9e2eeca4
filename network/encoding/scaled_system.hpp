// The system of a correction without units, as single-precision training data.
//
// The correction d of a base guess x_base solves A d = r, r = b - A x_base. With S = diag(A)^-1/2 and rho the root mean
// square of S r the system is
//   A^ d^ = r^,   A^ = S A S,   r^ = S r / rho,   d = rho S d^
// A^ is dimensionless, with a unit diagonal and entries below one; r^ has a root mean square of one. CG with Jacobi on
// A is plain CG on A^. Blocks are in the places of a JointForest, one block row per joint. For two coupled joints only
// the block in the later place's row and the earlier place's column is stored.
#pragma once

#include <vector>

#include "network/graph/joint_forest.hpp"
#include "network/layers/tensor.hpp"
#include "solver/linear/linear_system.hpp"

namespace rodsweep {

/// The places of the blocks of a rod's A; the same for all systems of the rod.
struct SystemPattern {
  struct Coupling {
    int row, column;                ///< places, row > column
    int block;                      ///< in the BlockMatrix
    int side = 0, column_side = 0;  ///< which segment of the row's joint, and of the column's, couples them; 0: the one
                                    ///< shared with the earliest place, 1: the other
  };
  std::vector<int> joint;           ///< of each place
  std::vector<int> diagonal;        ///< block of each place
  std::vector<Coupling> couplings;  ///< by row
  std::vector<int> to_parent;       ///< index of each place's coupling to its parent, -1 at a root
};

SystemPattern system_pattern(const JointForest& forest, const BlockMatrix& a);

/// One system, or several side by side.
template <class T>
struct ScaledSystem {
  Tensor<T> diagonal;                              ///< [36, places] blocks of A^, column-major
  Tensor<T> coupling;                              ///< [36, couplings]
  std::vector<SystemPattern::Coupling> couplings;  ///< `block` counts columns of `coupling` here
  Tensor<T> residual;                              ///< [6, places] r^
  std::vector<int> first_place;                    ///< of each system, and the end
  std::vector<double> base_energy,                 ///< per system: (x - x_base)^T A (x - x_base), over rho^2
      unit_energy;                                 ///< of losses: x^T A x, or the base's if that is greater

  int systems() const { return static_cast<int>(base_energy.size()); }
};

/// Sets rho S per unknown, in the order of joints: d = scale * d^; returns rho. Both are zero if the residual is.
double correction_scale(const BlockMatrix& a, const VectorX& residual, VectorX& scale);

/// `error` is x - x_base, with A x = b.
ScaledSystem<float> scaled_system(const SystemPattern& pattern, const BlockMatrix& a, const VectorX& residual,
                                  const VectorX& error, double unit_energy);

/// The same in other frames and scales: put_residual(place, six floats) writes r^ of a place; put_block(block, row,
/// column, 36 floats) writes the block of A^ that corresponds to `block` of A. `rho` as in correction_scale().
template <class PutResidual, class PutBlock>
ScaledSystem<float> scaled_system_of(const SystemPattern& pattern, const BlockMatrix& a, double rho, double base_energy,
                                     double unit_energy, const PutResidual& put_residual, const PutBlock& put_block) {
  const auto block_at = [&](int index) -> const Block6& { return a.blocks[static_cast<std::size_t>(index)]; };
  const auto places = static_cast<int>(pattern.joint.size());
  ScaledSystem<float> out;
  out.diagonal.resize(36, places);
  out.residual.resize(6, places);
  for (int i = 0; i < places; ++i) {
    put_block(block_at(pattern.diagonal[static_cast<std::size_t>(i)]), i, i, out.diagonal.col(i).data());
    put_residual(i, out.residual.col(i).data());
  }
  out.coupling.resize(36, static_cast<Eigen::Index>(pattern.couplings.size()));
  out.couplings = pattern.couplings;
  for (std::size_t k = 0; k < out.couplings.size(); ++k) {
    SystemPattern::Coupling& c = out.couplings[k];
    put_block(block_at(c.block), c.row, c.column, out.coupling.col(static_cast<Eigen::Index>(k)).data());
    c.block = static_cast<int>(k);
  }
  out.first_place = {0, places};
  const double inverse_rho = rho > 0 ? 1 / rho : 0;
  out.base_energy = {base_energy * inverse_rho * inverse_rho};
  out.unit_energy = {unit_energy * inverse_rho * inverse_rho};
  return out;
}

/// S_row block S_column, column by column; both scales have six entries.
template <class Scale>
void write_scaled(const Block6& block, const Scale& row, const Scale& column, float* out) {
  for (int c = 0; c < 6; ++c)
    for (int r = 0; r < 6; ++r) out[6 * c + r] = static_cast<float>(row[r] * block.column[c][r] * column[c]);
}

template <class T>
ScaledSystem<T> side_by_side(const std::vector<const ScaledSystem<float>*>& systems);

/// y = A^ x, [6, places].
template <class T>
void multiply(const ScaledSystem<T>& a, const TensorIn<T>& x, Eigen::Ref<Tensor<T>> y);

}  // namespace rodsweep
