#include "solver/factor/incomplete_factor.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "solver/factor/elimination_order.hpp"
#include "solver/linear/block_kernels.hpp"

namespace rodsweep {
namespace {

using Lane8f = float __attribute__((vector_size(32)));
using TwoRows = float __attribute__((vector_size(64)));

TwoRows twice(const Lane8f& v) { return __builtin_shufflevector(v, v, 0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7); }

Lane8f folded(const TwoRows& v) {
  return __builtin_shufflevector(v, v, 0, 1, 2, 3, 4, 5, 6, 7) +
         __builtin_shufflevector(v, v, 8, 9, 10, 11, 12, 13, 14, 15);
}

/// Lanes 2i and 2i + 1, eight times each: the factors of two rows.
template <int i>
TwoRows factors(const Lane8f& v) {
  constexpr int a = 2 * i, b = a + 1;
  return __builtin_shufflevector(v, v, a, a, a, a, a, a, a, a, b, b, b, b, b, b, b, b);
}

/// Lanes 0..5, and again 8..13: the sums of six rows.
TwoRows row_sums_twice(const TwoRows (&t)[3]) {
  const TwoRows u = __builtin_shufflevector(t[0], t[1], 0, 16, 2, 18, 4, 20, 6, 22, 8, 24, 10, 26, 12, 28, 14, 30) +
                    __builtin_shufflevector(t[0], t[1], 1, 17, 3, 19, 5, 21, 7, 23, 9, 25, 11, 27, 13, 29, 15, 31);
  const TwoRows w = t[2] + __builtin_shufflevector(t[2], t[2], 1, 0, 3, 2, 5, 4, 7, 6, 9, 8, 11, 10, 13, 12, 15, 14);
  // In every group of four lanes, sums of four lanes: of t[0], of t[1], and of t[2] twice.
  const TwoRows v = __builtin_shufflevector(u, w, 0, 1, 16, 16, 4, 5, 20, 20, 8, 9, 24, 24, 12, 13, 28, 28) +
                    __builtin_shufflevector(u, w, 2, 3, 18, 18, 6, 7, 22, 22, 10, 11, 26, 26, 14, 15, 30, 30);
  const TwoRows s = v + __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11);
  return __builtin_shufflevector(s, TwoRows{}, 0, 8, 1, 9, 2, 10, 16, 16, 0, 8, 1, 9, 2, 10, 16, 16);
}

Lane8f narrowed(const Lane8& v) { return __builtin_convertvector(v, Lane8f); }

TwoRows joined(const Lane8f& a, const Lane8f& b) {
  return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

constexpr double least_shift = 1e-4, shift_growth = 4, most_shift = 20;

/// Later neighbours of every position in the order of elimination, ascending, with fill up to `levels`.
std::vector<std::map<int, int>> later_neighbours(const BlockMatrix& pattern, const std::vector<int>& position,
                                                 int levels) {
  std::vector<std::map<int, int>> later(position.size());  // and the levels of their couplings
  for (int row = 0; row < pattern.block_rows(); ++row)
    for (int k = pattern.row_begin(row); k < pattern.row_end(row); ++k) {
      const int i = position[at(row)];
      const int j = position[at(pattern.column(k))];
      if (j > i) later[at(i)][j] = 0;
    }
  for (const std::map<int, int>& neighbours : later)
    for (auto i = neighbours.begin(); i != neighbours.end(); ++i)
      for (auto j = std::next(i); j != neighbours.end(); ++j) {
        const int level = i->second + j->second + 1;
        if (level > levels) continue;
        int& known = later[at(i->first)].emplace(j->first, level).first->second;
        known = std::min(known, level);
      }
  return later;
}

}  // namespace

IncompleteFactor::IncompleteFactor(const BlockMatrix& pattern, const std::vector<int>& order, int levels) {
  const std::size_t n = order.size();
  const std::vector<int> row_at(order.rbegin(), order.rend()), position = inverse(row_at);
  std::vector<std::map<int, int>> entries =
      later_neighbours(pattern, position, levels);  // levels, then entries of off_
  for (std::size_t i = 0; i < n; ++i) {
    Column column{row_at[i], static_cast<int>(off_.size()), 0, 0};
    for (auto& [neighbour, entry] : entries[i]) {
      entry = static_cast<int>(off_.size());
      // Row r of B = A_kp is column r of A_pk.
      off_.push_back({neighbour, pattern.find(row_at[at(neighbour)], row_at[i]), 0});
    }
    column.off_end = static_cast<int>(off_.size());
    columns_.push_back(column);
  }
  for (Column& column : columns_) {
    column.update_begin = static_cast<int>(updates_.size());
    for (int q = column.off_begin; q < column.off_end; ++q)
      for (int p = column.off_begin; p < q; ++p) {
        const auto& of_p = entries[at(off_[at(p)].position)];
        const auto target = of_p.find(off_[at(q)].position);
        if (target == of_p.end()) continue;
        updates_.push_back({p, target->second});
        ++off_[at(q)].updates;
      }
  }
  diagonal_work_.resize(n);
  off_work_.resize(off_.size());
  inverse_.resize(n);
  factor_.resize(off_.size());
  solution_.resize(n);
}

bool IncompleteFactor::factorise(const BlockMatrix& a) {
  const double largest = largest_diagonal_entry(a);
  scale_ = std::isfinite(largest) && largest > 0 ? std::exp2(std::ilogb(largest)) : 1;
  shift_ = 0;
  if (eliminate(a)) return true;
  for (shift_ = least_shift; shift_ < most_shift; shift_ *= shift_growth)
    if (eliminate(a)) return true;
  return false;
}

bool IncompleteFactor::eliminate(const BlockMatrix& a) {
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    diagonal_work_[i] = a.blocks[at(a.diagonal(columns_[i].row))];
    for (int r = 0; r < 6; ++r) diagonal_work_[i].column[r] += shift_ * (diagonal_work_[i].column[r] * unit_lane[r]);
  }
  for (std::size_t p = 0; p < off_.size(); ++p)
    off_work_[p] = off_[p].source < 0 ? Block6{} : a.blocks[at(off_[p].source)];
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Column& column = columns_[i];
    RowFactor factor;
    if (!decompose(diagonal_work_[i], factor)) return false;
    Block6 inverse{{unit_lane[0], unit_lane[1], unit_lane[2], unit_lane[3], unit_lane[4], unit_lane[5]}};
    solve_rows(factor, inverse);
    narrow(inverse, scale_, inverse_[i]);
    const Update* update = updates_.data() + column.update_begin;
    for (int q = column.off_begin; q < column.off_end; ++q) {
      const Off& off = off_[at(q)];
      const Block6& b = off_work_[at(q)];
      Block6 x = b;
      solve_rows(factor, x);
      for (const Update* const end = update + off.updates; update < end; ++update) {
        Block6& target = off_work_[at(update->target)];
        subtract_product(target, off_work_[at(update->p)], x, target);
      }
      Block6& diagonal = diagonal_work_[at(off.position)];
      subtract_product(diagonal, b, x, diagonal);
      narrow(x, 1, factor_[at(q)]);
    }
  }
  return true;
}

void IncompleteFactor::narrow(const Block6& rows, double scale, FloatBlock& out) {
  for (int i = 0; i < 3; ++i)
    out.rows[i] = joined(narrowed(scale * rows.column[2 * i]), narrowed(scale * rows.column[2 * i + 1]));
}

void IncompleteFactor::apply(const double* r, double* z) {
  const std::size_t n = columns_.size();
  for (std::size_t i = 0; i < n; ++i) solution_[i] = joined(narrowed(load6(r + 6 * columns_[i].row)), Lane8f{});
  for (std::size_t i = 0; i < n; ++i) {
    const Column& column = columns_[i];
    const Lane8f b = folded(solution_[i]);
    const TwoRows b01 = factors<0>(b), b23 = factors<1>(b), b45 = factors<2>(b);
    for (int p = column.off_begin; p < column.off_end; ++p) {
      const FloatBlock& x = factor_[at(p)];
      TwoRows& to = solution_[at(off_[at(p)].position)];
      to = to - x.rows[0] * b01 - x.rows[1] * b23 - x.rows[2] * b45;
    }
    const FloatBlock& s = inverse_[i];
    solution_[i] = twice(folded(s.rows[0] * b01 + s.rows[1] * b23 + s.rows[2] * b45));
  }
  const double unscale = 1 / scale_;
  for (std::size_t i = n; i-- > 0;) {
    const Column& column = columns_[i];
    TwoRows terms[3]{};
    for (int p = column.off_begin; p < column.off_end; ++p) {
      const FloatBlock& x = factor_[at(p)];
      const TwoRows& known = solution_[at(off_[at(p)].position)];
      for (int j = 0; j < 3; ++j) terms[j] += x.rows[j] * known;
    }
    if (column.off_begin < column.off_end) solution_[i] -= row_sums_twice(terms);
    const Lane8f x = __builtin_shufflevector(solution_[i], solution_[i], 0, 1, 2, 3, 4, 5, 6, 7);
    store6(z + 6 * column.row, __builtin_convertvector(x, Lane8) * unscale);
  }
}

}  // namespace rodsweep
