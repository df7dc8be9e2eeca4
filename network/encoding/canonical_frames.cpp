#include "network/encoding/canonical_frames.hpp"

#include <cmath>

namespace rodsweep {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

CanonicalFrame frame_of(double c, double s, double hand) {
  return {Lane8{c, hand * c, 1, hand * c, c, hand, 0, 0}, Lane8{-s, hand * s, 0, -hand * s, s, 0, 0, 0}};
}

/// Of the diagonal, one number for both transverse rows of a kind.
Lane4 diagonal_of(const Block6& block) {
  return Lane4{(block.column[0][0] + block.column[1][1]) / 2, block.column[2][2],
               (block.column[3][3] + block.column[4][4]) / 2, block.column[5][5]};
}

Lane8 inverse_root(Lane8 values) {
  Eigen::Map<Eigen::Array<double, 8, 1>, sizeof(Lane8)> entries(reinterpret_cast<double*>(&values));
  entries = entries.sqrt();
  return 1 / values;
}

void write_scaled(const Block6& block, const Lane8& row, const Lane8& column, float* out) {
  for (int c = 0; c < 6; ++c)
    for (int r = 0; r < 6; ++r) out[6 * c + r] = static_cast<float>(row[r] * block.column[c][r] * column[c]);
}

}  // namespace

Block6 seen(const Block6& block, const CanonicalFrame& row, const CanonicalFrame& column) {
  Block6 half, out;
  for (int c = 0; c < 6; ++c) half.column[c] = row(block.column[c]);
  constexpr int other[6] = {1, 0, 2, 4, 3, 5};
  for (int c = 0; c < 6; ++c)
    out.column[c] = column.along[c] * half.column[c] + column.across[c] * half.column[other[c]];
  return out;
}

CanonicalFrames::CanonicalFrames(const SystemPattern& pattern)
    : parent_(pattern.joint.size(), -1),
      frames_(pattern.joint.size()),
      scales_(pattern.joint.size()),
      roll_x_(pattern.joint.size()),
      roll_y_(pattern.joint.size()) {
  for (std::size_t place = 0; place < pattern.joint.size(); ++place) {
    const int coupling = pattern.to_parent[place];
    if (coupling >= 0) parent_[place] = pattern.couplings[at(coupling)].column;
    tree_.push_back(coupling >= 0 ? tree_[at(parent_[place])] : static_cast<int>(trees_.size()));
    if (coupling < 0) trees_.emplace_back();
  }
}

void CanonicalFrames::find(const SystemPattern& pattern, const BlockMatrix& a, const VectorX& residual) {
  for (Tree& tree : trees_) tree = {};
  double sum = 0;
  for (std::size_t place = 0; place < frames_.size(); ++place) {
    // All roots of a joint at once: of the diagonal, and of the size of what its roll is read from.
    const Lane4 diagonal = diagonal_of(a.blocks[at(pattern.diagonal[place])]);
    const int parent = parent_[place];
    double re = 1, im = 0;
    if (parent >= 0) {
      const Block6& block = a.blocks[at(pattern.couplings[at(pattern.to_parent[place])].block)];
      re = -(block.column[3][3] + block.column[4][4]);
      im = block.column[4][3] - block.column[3][4];
      if (re == 0 && im == 0) re = 1;
    }
    const Lane8 roots =
        inverse_root(Lane8{diagonal[0], diagonal[1], diagonal[2], diagonal[3], re * re + im * im, 1, 1, 1});
    const Lane8 scale = scales_[place] = __builtin_shufflevector(roots, Lane8{}, 0, 0, 1, 2, 2, 3, 8, 8);
    const Lane8 r = scale * load6(residual.data() + 6 * pattern.joint[place]);
    double x = 1, y = 0;
    if (parent >= 0) {
      const double u = re * roots[4], v = im * roots[4];
      x = roll_x_[at(parent)] * u + roll_y_[at(parent)] * v;
      y = roll_y_[at(parent)] * u - roll_x_[at(parent)] * v;
    }
    roll_x_[place] = x;
    roll_y_[place] = y;
    const double shear_x = x * r[0] - y * r[1], shear_y = x * r[1] + y * r[0];
    const double bend_x = x * r[3] - y * r[4], bend_y = x * r[4] + y * r[3];
    Tree& tree = trees_[at(tree_[place])];
    tree.second_x += shear_x * shear_x - shear_y * shear_y - bend_x * bend_x + bend_y * bend_y;
    tree.second_y += 2 * (shear_x * shear_y - bend_x * bend_y);
    tree.first_x += shear_x;
    tree.first_y += shear_y;
    tree.twist += r[5];
    sum += r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3] + r[4] * r[4] + r[5] * r[5];
  }
  rho_ = std::sqrt(sum / a.unknowns());
  const double noise = 1e-6 * rho_ * static_cast<double>(frames_.size());
  for (Tree& tree : trees_) {
    // The root of a complex number, by half of its angle; `first` becomes conj of the axis.
    const double size = std::hypot(tree.second_x, tree.second_y);
    const double cosine = size > 0 ? tree.second_x / size : 1;
    const double x = std::sqrt((1 + cosine) / 2), y = std::copysign(std::sqrt((1 - cosine) / 2), tree.second_y);
    const double sign = x * tree.first_x + y * tree.first_y < 0 ? -1 : 1;
    if (std::abs(tree.twist) < noise) tree.twist = sign * (x * tree.first_y - y * tree.first_x);
    tree.first_x = sign * x;
    tree.first_y = -sign * y;
  }
  for (std::size_t place = 0; place < frames_.size(); ++place) {
    const Tree& tree = trees_[at(tree_[place])];
    const double x = roll_x_[place], y = roll_y_[place];
    frames_[place] =
        frame_of(x * tree.first_x - y * tree.first_y, x * tree.first_y + y * tree.first_x, tree.twist < 0 ? -1 : 1);
  }
}

ScaledSystem<float> canonical_system(const SystemPattern& pattern, const CanonicalFrames& frames, const BlockMatrix& a,
                                     const VectorX& residual, const VectorX& error, double solution_energy) {
  const auto places = static_cast<int>(pattern.joint.size());
  const double inverse_rho = frames.rho() > 0 ? 1 / frames.rho() : 0;
  ScaledSystem<float> out;
  out.diagonal.resize(36, places);
  out.residual.resize(6, places);
  for (int i = 0; i < places; ++i) {
    const CanonicalFrame& frame = frames.frame(i);
    write_scaled(seen(a.blocks[at(pattern.diagonal[at(i)])], frame, frame), frames.scale(i), frames.scale(i),
                 out.diagonal.col(i).data());
    const Lane8 r = inverse_rho * frames.scale(i) * frame(load6(residual.data() + 6 * pattern.joint[at(i)]));
    for (int row = 0; row < 6; ++row) out.residual(row, i) = static_cast<float>(r[row]);
  }
  out.coupling.resize(36, static_cast<Eigen::Index>(pattern.couplings.size()));
  out.couplings = pattern.couplings;
  for (std::size_t k = 0; k < out.couplings.size(); ++k) {
    SystemPattern::Coupling& c = out.couplings[k];
    write_scaled(seen(a.blocks[at(c.block)], frames.frame(c.row), frames.frame(c.column)), frames.scale(c.row),
                 frames.scale(c.column), out.coupling.col(static_cast<Eigen::Index>(k)).data());
    c.block = static_cast<int>(k);
  }
  out.first_place = {0, places};
  out.base_energy = {error.dot(residual) * inverse_rho * inverse_rho};
  out.solution_energy = {solution_energy * inverse_rho * inverse_rho};
  return out;
}

}  // namespace rodsweep
