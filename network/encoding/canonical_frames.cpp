#include "network/encoding/canonical_frames.hpp"

#include <algorithm>
#include <cmath>

namespace rodsweep {
namespace {

/// The frame that is rolled by t = c + i s, and mirrored if `hand` is -1.
struct Hand {
  Lane8 cosine, always, sine;

  explicit Hand(double hand)
      : cosine{1, hand, 0, hand, 1, 0, 0, 0}, always{0, 0, 1, 0, 0, hand, 0, 0}, sine{-1, hand, 0, -hand, 1, 0, 0, 0} {}
  CanonicalFrame frame(double c, double s) const { return {c * cosine + always, s * sine}; }
};

/// The diagonal, averaged over both transverse rows of a kind.
Lane4 diagonal_of(const Block6& block) {
  return Lane4{(block.column[0][0] + block.column[1][1]) / 2, block.column[2][2],
               (block.column[3][3] + block.column[4][4]) / 2, block.column[5][5]};
}

/// 1 / (bending entry of the first diagonal block), or 1 for a rod without joints.
double bending_unit(const SystemPattern& pattern, const BlockMatrix& a) {
  return pattern.diagonal.empty() ? 1 : 1 / diagonal_of(a.blocks[at(pattern.diagonal[0])])[2];
}

/// 1 / sqrt(values). Single precision is enough for scales and takes a third of the time.
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

CanonicalFrames::CanonicalFrames(const SystemPattern& pattern, Alignment alignment)
    : alignment_(alignment),
      frames_(pattern.joint.size()),
      scales_(pattern.joint.size()),
      roll_(pattern.joint.size()),
      bent_(pattern.joint.size()) {
  for (std::size_t place = 0; place < pattern.joint.size(); ++place) {
    const int k = pattern.to_parent[place];
    tree_.push_back(k >= 0 ? tree_[at(pattern.couplings[at(k)].column)] : static_cast<int>(trees_.size()));
    if (k < 0) trees_.emplace_back();
  }
}

void CanonicalFrames::find(const SystemPattern& pattern, const BlockMatrix& a, const VectorX& residual) {
  for (Tree& tree : trees_) tree = {};
  carry(pattern, a, residual);
  if (alignment_ == Alignment::matrix) orient_by_matrix(pattern, a);
  const auto known = [](const Tree& tree) { return (tree.axis.x != 0 || tree.axis.y != 0) && tree.hand != 0; };
  if (!std::all_of(trees_.begin(), trees_.end(), known)) orient_by_residual(pattern, residual);
  const Hand right(1), left(-1);
  for (std::size_t place = 0; place < frames_.size(); ++place) {
    const Tree& tree = trees_[at(tree_[place])];
    const auto [x, y] = roll_[place];
    frames_[place] =
        (tree.hand < 0 ? left : right).frame(x * tree.axis.x + y * tree.axis.y, y * tree.axis.x - x * tree.axis.y);
  }
}

/// Sets scales, rho and the rolls along the trees.
void CanonicalFrames::carry(const SystemPattern& pattern, const BlockMatrix& a, const VectorX& residual) {
  double sum = 0;
  // Removes the unit of the entries that give the rolls, so that their squares fit single precision for any rod.
  const double unit = bending_unit(pattern, a);
  for (std::size_t place = 0; place < frames_.size(); ++place) {
    // All inverse roots of a joint at once: of the diagonal, and of |re + i im|^2, which gives the roll.
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
    scales_[place] = __builtin_shufflevector(roots, Lane8{}, 0, 0, 1, 2, 2, 3, 8, 8);
    const Lane8 r = scales_[place] * load6(residual.data() + 6 * pattern.joint[place]);
    sum += r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3] + r[4] * r[4] + r[5] * r[5];
    roll_[place] = {1, 0};
    if (!parent) continue;
    const double u = re * roots[4], v = im * roots[4];
    const Pair& from = roll_[at(parent->column)];
    roll_[place] = {from.x * u + from.y * v, from.y * u - from.x * v};
  }
  rho_ = std::sqrt(sum / a.unknowns());
}

/// Sets the axes of bent trees, and the hands of trees that are not flat.
void CanonicalFrames::orient_by_matrix(const SystemPattern& pattern, const BlockMatrix& a) {
  const double unit = bending_unit(pattern, a);
  for (std::size_t place = 0; place < frames_.size(); ++place) {
    const int k = pattern.to_parent[place];
    bent_[place] = {};
    if (k < 0) continue;
    const SystemPattern::Coupling& parent = pattern.couplings[at(k)];
    const Lane8& column = a.blocks[at(parent.block)].column[5];
    const Pair& roll = roll_[place];
    const Pair& before = bent_[at(parent.column)];
    const double v = unit * column[3], w = unit * column[4];
    const Pair here = bent_[place] = {roll.x * v - roll.y * w, roll.x * w + roll.y * v};
    Moments& moments = trees_[at(tree_[place])].moments;
    moments.second.x += here.x * here.x - here.y * here.y;
    moments.second.y += 2 * here.x * here.y;
    moments.first.x += here.x;
    moments.first.y += here.y;
    moments.size += here.x * here.x + here.y * here.y;
    moments.hand += before.x * here.y - before.y * here.x;
  }
  for (Tree& tree : trees_) {
    constexpr double straight = 1e-12, flat = 1e-6;  // sum of squared angles; sine of the angle between planes
    if (tree.moments.size < straight * static_cast<double>(frames_.size())) continue;
    set_axis(tree);
    if (std::abs(tree.moments.hand) > flat * tree.moments.size) tree.hand = tree.moments.hand;
  }
}

/// Sets the axes and hands that are not known yet.
void CanonicalFrames::orient_by_residual(const SystemPattern& pattern, const VectorX& residual) {
  for (Tree& tree : trees_) tree.moments = {};
  for (std::size_t place = 0; place < frames_.size(); ++place) {
    const Lane8 r = scales_[place] * load6(residual.data() + 6 * pattern.joint[place]);
    const auto [x, y] = roll_[place];
    const double shear_x = x * r[0] - y * r[1], shear_y = x * r[1] + y * r[0];
    const double bend_x = x * r[3] - y * r[4], bend_y = x * r[4] + y * r[3];
    Moments& moments = trees_[at(tree_[place])].moments;
    moments.second.x += shear_x * shear_x - shear_y * shear_y - bend_x * bend_x + bend_y * bend_y;
    moments.second.y += 2 * (shear_x * shear_y - bend_x * bend_y);
    moments.first.x += shear_x;
    moments.first.y += shear_y;
    moments.hand += r[5];
  }
  const double noise = 1e-6 * rho_ * static_cast<double>(frames_.size());
  for (Tree& tree : trees_) {
    if (tree.axis.x == 0 && tree.axis.y == 0) set_axis(tree);
    if (tree.hand != 0) continue;
    const bool twisted = std::abs(tree.moments.hand) >= noise;
    tree.hand = twisted ? tree.moments.hand : tree.axis.x * tree.moments.first.y - tree.axis.y * tree.moments.first.x;
  }
}

/// The axis is the square root of the second moment (half its angle). Its sign points towards the first moment.
void CanonicalFrames::set_axis(Tree& tree) {
  const auto& [first, second, size, hand] = tree.moments;
  const double length = std::hypot(second.x, second.y);
  const double cosine = length > 0 ? second.x / length : 1;
  const double x = std::sqrt((1 + cosine) / 2), y = std::copysign(std::sqrt((1 - cosine) / 2), second.y);
  const double sign = x * first.x + y * first.y < 0 ? -1 : 1;
  tree.axis = {sign * x, sign * y};
}

ScaledSystem<float> canonical_system(const SystemPattern& pattern, const CanonicalFrames& frames, const BlockMatrix& a,
                                     const VectorX& residual, const VectorX& error, double unit_energy) {
  const double inverse_rho = frames.rho() > 0 ? 1 / frames.rho() : 0;
  return scaled_system_of(
      pattern, a, frames.rho(), error.dot(residual), unit_energy,
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
