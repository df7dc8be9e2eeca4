#include "solver/linear/block_factor.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <set>

#include "solver/linear/block_kernels.hpp"
#include "solver/linear/elimination_order.hpp"

namespace rodsweep {
namespace {

/// X^T b of the rows of X.
inline Lane8 combined(const Block6& x, const Lane8& b) {
  Lane8 sum = x.column[0] * b[0];
#pragma GCC unroll 6
  for (int r = 1; r < 6; ++r) sum += x.column[r] * b[r];
  return sum;
}

/// From about as many joints on, a matrix comes from memory, which likes to be read along the rod: branch after branch.
constexpr int most_in_cache = 4096;

}  // namespace

std::vector<int> root_to_leaf_order(const Rod& rod) {
  std::vector<std::vector<int>> joints_of(rod.segments.size());
  for (int k = 0; k < rod.joint_count(); ++k) {
    joints_of[static_cast<std::size_t>(rod.joints[static_cast<std::size_t>(k)].a)].push_back(k);
    joints_of[static_cast<std::size_t>(rod.joints[static_cast<std::size_t>(k)].b)].push_back(k);
  }
  std::vector<std::size_t> left(rod.segments.size());  // joints of a segment that are not eliminated
  for (std::size_t s = 0; s < left.size(); ++s) left[s] = joints_of[s].size();
  std::deque<int> free;  // joints that no other one waits for
  std::vector<bool> seen(rod.joints.size(), false);
  const auto see = [&](int k) {
    if (!seen[static_cast<std::size_t>(k)]) free.push_back(k);
    seen[static_cast<std::size_t>(k)] = true;
  };
  const auto see_all_of = [&](std::size_t s) {
    for (const int k : joints_of[s]) see(k);
  };
  for (std::size_t s = 0; s < left.size(); ++s)
    if (left[s] == 1 || rod.segments[s].is_static) see_all_of(s);
  std::vector<int> order;  // of elimination
  const auto eliminate_free = [&] {
    while (!free.empty()) {
      const int k = rod.joint_count() > most_in_cache ? free.back() : free.front();
      rod.joint_count() > most_in_cache ? free.pop_back() : free.pop_front();
      order.push_back(k);
      const Joint& joint = rod.joints[static_cast<std::size_t>(k)];
      for (const int s : {joint.a, joint.b})
        if (--left[static_cast<std::size_t>(s)] == 1) see_all_of(static_cast<std::size_t>(s));
    }
  };
  eliminate_free();
  for (int k = 0; k < rod.joint_count(); ++k) see(k);  // of loops, and between them
  eliminate_free();
  std::reverse(order.begin(), order.end());
  return order;
}

BlockFactor::BlockFactor(const BlockMatrix& pattern, const std::vector<int>& preferred) {
  const std::vector<int> order = fills_in(pattern, preferred) ? minimum_degree_order(pattern) : preferred;
  const std::size_t n = order.size();
  std::vector<int> position(n);
  for (std::size_t i = 0; i < n; ++i) position[static_cast<std::size_t>(order[i])] = static_cast<int>(n - 1 - i);

  // Symbolic elimination: the later neighbours of every column, fill included.
  std::vector<std::set<int>> later(n);
  for (int row = 0; row < pattern.block_rows(); ++row)
    for (int k = pattern.row_begin(row); k < pattern.row_end(row); ++k) {
      const int i = position[static_cast<std::size_t>(row)];
      const int j = position[static_cast<std::size_t>(pattern.column(k))];
      if (j > i) later[static_cast<std::size_t>(i)].insert(j);
    }
  std::vector<std::vector<int>> offs(n);
  for (std::size_t i = 0; i < n; ++i) {
    offs[i].assign(later[i].begin(), later[i].end());
    if (offs[i].empty()) continue;
    later[static_cast<std::size_t>(offs[i].front())].insert(offs[i].begin() + 1, offs[i].end());
  }

  std::vector<int> row_at(n);
  for (std::size_t row = 0; row < n; ++row) row_at[static_cast<std::size_t>(position[row])] = static_cast<int>(row);
  for (std::size_t i = 0; i < n; ++i) {
    Column column{row_at[i], static_cast<int>(off_.size()), 0, 0, pattern.diagonal(row_at[i]), false};
    for (const int p : offs[i]) {
      // Row r of B = A_kp is column r of A_pk.
      const int source = pattern.find(row_at[static_cast<std::size_t>(p)], row_at[i]);
      fill_in_ += source < 0;
      off_.push_back({p, source, false, false});
    }
    column.off_end = static_cast<int>(off_.size());
    columns_.push_back(column);
  }
  for (Column& column : columns_) {
    column.update_begin = static_cast<int>(updates_.size());
    for (int q = column.off_begin; q < column.off_end; ++q) {
      Off& off = off_[static_cast<std::size_t>(q)];
      Column& later_column = columns_[static_cast<std::size_t>(off.position)];
      off.first = !later_column.updated;
      later_column.updated = true;
      for (int p = column.off_begin; p < q; ++p) {
        int entry = columns_[static_cast<std::size_t>(off_[static_cast<std::size_t>(p)].position)].off_begin;
        while (off_[static_cast<std::size_t>(entry)].position != off_[static_cast<std::size_t>(q)].position) ++entry;
        updates_.push_back({entry, !off_[static_cast<std::size_t>(entry)].updated});
        off_[static_cast<std::size_t>(entry)].updated = true;
      }
    }
  }
  diagonal_work_.resize(n);
  off_work_.resize(off_.size());
  solution_.resize(n);
}

SolveOutcome BlockFactor::solve(const BlockMatrix& a, const VectorX& b, VectorX& x) {
  const bool positive = eliminate<false>(a, b.data());
  for (std::size_t i = columns_.size(); i-- > 0;) {
    const Column& column = columns_[i];
    if (column.off_begin < column.off_end) {
      Lane8 terms[6]{};
      Lane8 keep = Lane8{1, 1, 1, 1, 1, 1, 1, 0};  // y stands in lane 6 of every X_p: count it once
      for (int p = column.off_begin; p < column.off_end; ++p) {
        const Block6& off = off_work_[static_cast<std::size_t>(p)];
        const Lane8 known = keep * solution_[static_cast<std::size_t>(off_[static_cast<std::size_t>(p)].position)];
        for (int r = 0; r < 6; ++r) terms[r] += off.column[r] * known;
        keep = Lane8{1, 1, 1, 1, 1, 1, 0, 0};
      }
      solution_[i] = -sum_lanes(terms);
    }
    store6(x.data() + 6 * column.row, solution_[i]);
    solution_[i] = with_lane_6(solution_[i], broadcast(-1));
  }
  if (!positive) return SolveOutcome::indefinite;
  return std::isfinite(x.sum()) ? SolveOutcome::converged : SolveOutcome::not_a_number;
}

bool BlockFactor::factorise(const BlockMatrix& a) {
  inverse_.resize(columns_.size());
  return eliminate<true>(a, nullptr);
}

void BlockFactor::substitute(VectorX& x) {
  for (std::size_t i = 0; i < columns_.size(); ++i) solution_[i] = load6(x.data() + 6 * columns_[i].row);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Column& column = columns_[i];
    const Lane8 b = solution_[i];
    for (int p = column.off_begin; p < column.off_end; ++p)
      solution_[static_cast<std::size_t>(off_[static_cast<std::size_t>(p)].position)] -=
          combined(off_work_[static_cast<std::size_t>(p)], b);
    solution_[i] = combined(inverse_[i], b);
  }
  for (std::size_t i = columns_.size(); i-- > 0;) {
    const Column& column = columns_[i];
    Lane8 terms[6]{};
    for (int p = column.off_begin; p < column.off_end; ++p)
      for (int r = 0; r < 6; ++r)
        terms[r] += off_work_[static_cast<std::size_t>(p)].column[r] *
                    solution_[static_cast<std::size_t>(off_[static_cast<std::size_t>(p)].position)];
    if (column.off_begin < column.off_end) solution_[i] -= sum_lanes(terms);
    store6(x.data() + 6 * column.row, solution_[i]);
  }
}

template <bool keep_inverse>
bool BlockFactor::eliminate(const BlockMatrix& a, const double* b) {
  bool positive = true;
  const auto block_of = [&](int source) -> const Block6& {
    static constexpr Block6 zero{};
    return source < 0 ? zero : a.blocks[static_cast<std::size_t>(source)];
  };
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Column& column = columns_[i];
    const Block6& left = column.updated ? diagonal_work_[i] : block_of(column.diagonal_source);
    Block6 s;
    for (int r = 0; r < 6; ++r) s.column[r] = b ? left.column[r] + in_lane_6(b[6 * column.row + r]) : left.column[r];
    RowFactor factor;
    positive &= decompose(s, factor);
    if constexpr (keep_inverse) {
      inverse_[i] = {{unit_lane[0], unit_lane[1], unit_lane[2], unit_lane[3], unit_lane[4], unit_lane[5]}};
      solve_rows(factor, inverse_[i]);
    }
    if (column.off_begin == column.off_end) solution_[i] = solution(factor, s);

    const Update* update = updates_.data() + column.update_begin;
    for (int q = column.off_begin; q < column.off_end; ++q) {
      const Off& off = off_[static_cast<std::size_t>(q)];
      Block6& x = off_work_[static_cast<std::size_t>(q)];
      const Block6& before = off.updated ? x : block_of(off.source);
      // S^-1 is symmetric: B_p^T X_q = X_p^T B_q, and X_p is stored by now.
      for (int p = column.off_begin; p < q; ++p, ++update) {
        Block6& target = off_work_[static_cast<std::size_t>(update->target)];
        subtract_product(update->first ? block_of(off_[static_cast<std::size_t>(update->target)].source) : target,
                         off_work_[static_cast<std::size_t>(p)], before, target);
      }
      Block6 w, u;
#pragma GCC unroll 4
      for (int p = 0; p < slices; ++p) {
        RowSlice rows(before, p);
        forward(factor, rows);
        if (p == 6 / lane_width) rows.take_lane_6(s);
        rows.store(w, p);
        divide(factor, rows);
        rows.store(u, p);
        backward(factor, rows);
        rows.store(x, p);
      }
      const auto at = static_cast<std::size_t>(off.position);
      Block6& diagonal = diagonal_work_[at];
      subtract_product(off.first ? block_of(columns_[at].diagonal_source) : diagonal, w, u, diagonal);
    }
  }
  return positive;
}

}  // namespace rodsweep
