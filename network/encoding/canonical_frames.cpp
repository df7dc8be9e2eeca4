#include "network/encoding/canonical_frames.hpp"

#include <cmath>

namespace rodsweep {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// The frame of a hand, of c and s.
struct Hand {
  Lane8 cosine, always, sine;

  explicit Hand(double hand)
      : cosine{1, hand, 0, hand, 1, 0, 0, 0}, always{0, 0, 1, 0, 0, hand, 0, 0}, sine{-1, hand, 0, -hand, 1, 0, 0, 0} {}
  CanonicalFrame frame(double c, double s) const { return {c * cosine + always, s * sine}; }
};

/// Of the diagonal, one number for both transverse rows of a kind.
Lane4 diagonal_of(const Block6& block) {
  return Lane4{(block.column[0][0] + block.column[1][1]) / 2, block.column[2][2],
               (block.column[3][3] + block.column[4][4]) / 2, block.column[5][5]};
}

/// In single precision, which is enough for scales and a third of the time.
Lane8 inverse_root(const Lane8& values) {
  using FloatLane8 = float __attribute__((vector_size(32)));
  FloatLane8 roots = __builtin_convertvector(values, FloatLane8);
  Eigen::Map<Eigen::Array<float, 8, 1>, sizeof(FloatLane8)> entries(reinterpret_cast<float*>(&roots));
  entries = entries.sqrt();
  return __builtin_convertvector(1 / roots, Lane8);
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
    : frames_(pattern.joint.size()),
      scales_(pattern.joint.size()),
      roll_x_(pattern.joint.size()),
      roll_y_(pattern.joint.size()) {
  for (std::size_t place = 0; place < pattern.joint.size(); ++place) {
    const int k = pattern.to_parent[place];
    tree_.push_back(k >= 0 ? tree_[at(pattern.couplings[at(k)].column)] : static_cast<int>(trees_.size()));
    if (k < 0) trees_.emplace_back();
  }
}

void CanonicalFrames::find(const SystemPattern& pattern, const BlockMatrix& a, const VectorX& residual) {
  for (Tree& tree : trees_) tree = {};
  double sum = 0;
  // What rolls are read from, without its unit, so that its square is a single-precision number of any rod.
  const double unit = frames_.empty() ? 1 : 1 / diagonal_of(a.blocks[at(pattern.diagonal[0])])[2];
  for (std::size_t place = 0; place < frames_.size(); ++place) {
    // All roots of a joint at once: of the diagonal, and of the size of what its roll is read from.
    const Lane4 diagonal = diagonal_of(a.blocks[at(pattern.diagonal[place])]);
    const int k = pattern.to_parent[place];
    const SystemPattern::Coupling* parent = k >= 0 ? &pattern.couplings[at(k)] : nullptr;
    double re = 1, im = 0;
    if (parent) {
      const Block6& block = a.blocks[at(parent->block)];
      re = -unit * (block.column[3][3] + block.column[4][4]);
      im = unit * (block.column[4][3] - block.column[3][4]);
      if (re == 0 && im == 0) re = 1;
    }
    const Lane8 roots =
        inverse_root(Lane8{diagonal[0], diagonal[1], diagonal[2], diagonal[3], re * re + im * im, 1, 1, 1});
    const Lane8 scale = scales_[place] = __builtin_shufflevector(roots, Lane8{}, 0, 0, 1, 2, 2, 3, 8, 8);
    const Lane8 r = scale * load6(residual.data() + 6 * pattern.joint[place]);
    double x = 1, y = 0;
    if (parent) {
      const double u = re * roots[4], v = im * roots[4];
      const double from_x = roll_x_[at(parent->column)], from_y = roll_y_[at(parent->column)];
      x = from_x * u + from_y * v;
      y = from_y * u - from_x * v;
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
  const Hand right(1), left(-1);
  for (std::size_t place = 0; place < frames_.size(); ++place) {
    const Tree& tree = trees_[at(tree_[place])];
    const double x = roll_x_[place], y = roll_y_[place];
    frames_[place] =
        (tree.twist < 0 ? left : right).frame(x * tree.first_x - y * tree.first_y, x * tree.first_y + y * tree.first_x);
  }
}

ScaledSystem<float> canonical_system(const SystemPattern& pattern, const CanonicalFrames& frames, const BlockMatrix& a,
                                     const VectorX& residual, const VectorX& error, double solution_energy) {
  const double inverse_rho = frames.rho() > 0 ? 1 / frames.rho() : 0;
  return scaled_system_of(
      pattern, a, frames.rho(), error.dot(residual), solution_energy,
      [&](int place, float* out) {
        const Lane8 r = inverse_rho * frames.scale(place) *
                        frames.frame(place)(load6(residual.data() + 6 * pattern.joint[at(place)]));
        for (int row = 0; row < 6; ++row) out[row] = static_cast<float>(r[row]);
      },
      [&](const Block6& block, int row, int column, float* out) {
        write_scaled(seen(block, frames.frame(row), frames.frame(column)), frames.scale(row), frames.scale(column),
                     out);
      });
}

}  // namespace rodsweep
