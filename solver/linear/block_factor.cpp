#include "solver/linear/block_factor.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "solver/linear/block_kernels.hpp"
#include "solver/linear/elimination_order.hpp"

namespace rodsweep {
namespace {

/// b <- S^-1 b on the rows of b.
inline void solve_rows(const RowOperations& ops, Lane8 (&b)[6]) {
#pragma GCC unroll 6
  for (int j = 0; j < 6; ++j)
#pragma GCC unroll 6
    for (int k = 0; k < 6; ++k)
      if (k != j) b[k] -= ops.factor[j][k] * b[j];
#pragma GCC unroll 6
  for (int j = 0; j < 6; ++j) b[j] *= ops.inverse[j];
}

/// target -= B^T X over the rows of B and X.
inline void subtract_product(Block6& target, const Lane8* b, const Lane8* x) {
#pragma GCC unroll 6
  for (int r = 0; r < 6; ++r) {
    Lane8 row = target.column[r];
#pragma GCC unroll 6
    for (int j = 0; j < 6; ++j) row -= b[j][r] * x[j];
    target.column[r] = row;
  }
}

/// X^T b of the rows of X.
inline Lane8 combined(const Block6& x, const Lane8& b) {
  Lane8 sum = x.column[0] * b[0];
#pragma GCC unroll 6
  for (int r = 1; r < 6; ++r) sum += x.column[r] * b[r];
  return sum;
}

}  // namespace

std::vector<int> root_to_leaf_order(const Rod& rod) {
  std::vector<std::vector<int>> joints_of(rod.segments.size());
  for (int k = 0; k < rod.joint_count(); ++k) {
    joints_of[static_cast<std::size_t>(rod.joints[static_cast<std::size_t>(k)].a)].push_back(k);
    joints_of[static_cast<std::size_t>(rod.joints[static_cast<std::size_t>(k)].b)].push_back(k);
  }
  std::vector<int> order, open;
  std::vector<bool> joint_seen(rod.joints.size(), false), segment_seen(rod.segments.size(), false);
  const auto visit_from = [&](int root) {
    if (segment_seen[static_cast<std::size_t>(root)]) return;
    segment_seen[static_cast<std::size_t>(root)] = true;
    open.assign(1, root);
    while (!open.empty()) {
      const int segment = open.back();
      open.pop_back();
      for (const int k : joints_of[static_cast<std::size_t>(segment)]) {
        if (joint_seen[static_cast<std::size_t>(k)]) continue;
        joint_seen[static_cast<std::size_t>(k)] = true;
        order.push_back(k);
        const Joint& joint = rod.joints[static_cast<std::size_t>(k)];
        const int other = joint.a == segment ? joint.b : joint.a;
        if (segment_seen[static_cast<std::size_t>(other)]) continue;
        segment_seen[static_cast<std::size_t>(other)] = true;
        open.push_back(other);
      }
    }
  };
  for (int s = 0; s < rod.segment_count(); ++s)
    if (rod.segments[static_cast<std::size_t>(s)].is_static) visit_from(s);
  for (int s = 0; s < rod.segment_count(); ++s) visit_from(s);
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
    Column column{row_at[i], static_cast<int>(off_.size()), 0, 0, pattern.diagonal(row_at[i])};
    for (const int p : offs[i]) {
      // Row r of B = A_kp is column r of A_pk.
      const int source = pattern.find(row_at[static_cast<std::size_t>(p)], row_at[i]);
      fill_in_ += source < 0;
      off_.push_back({p, source});
    }
    column.off_end = static_cast<int>(off_.size());
    columns_.push_back(column);
  }
  for (Column& column : columns_) {
    column.update_begin = static_cast<int>(updates_.size());
    for (int q = column.off_begin; q < column.off_end; ++q)
      for (int p = column.off_begin; p < q; ++p) {
        int entry = columns_[static_cast<std::size_t>(off_[static_cast<std::size_t>(p)].position)].off_begin;
        while (off_[static_cast<std::size_t>(entry)].position != off_[static_cast<std::size_t>(q)].position) ++entry;
        updates_.push_back(entry);
      }
  }
  diagonal_work_.resize(n);
  off_work_.resize(off_.size());
  solution_.resize(n);
}

void BlockFactor::load(const BlockMatrix& a, const double* b) {
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Column& column = columns_[i];
    Block6& diagonal = diagonal_work_[i];
    diagonal = a.blocks[static_cast<std::size_t>(column.diagonal_source)];
    for (int r = 0; r < 6; ++r)
      diagonal.column[r] = with_lane_6(diagonal.column[r], broadcast(b ? b[6 * column.row + r] : 0));
    for (int p = column.off_begin; p < column.off_end; ++p) {
      const int source = off_[static_cast<std::size_t>(p)].source;
      off_work_[static_cast<std::size_t>(p)] = source < 0 ? Block6{} : a.blocks[static_cast<std::size_t>(source)];
    }
  }
}

SolveOutcome BlockFactor::solve(const BlockMatrix& a, const VectorX& b, VectorX& x) {
  load(a, b.data());
  const bool positive = eliminate<false>();
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
  load(a, nullptr);
  return eliminate<true>();
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
bool BlockFactor::eliminate() {
  bool positive = true;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Column& column = columns_[i];
    Lane8 s[6];
    for (int r = 0; r < 6; ++r) s[r] = diagonal_work_[i].column[r];
    const Lane8 rhs[6] = {s[0], s[1], s[2], s[3], s[4], s[5]};  // in lane 6
    RowOperations ops;
    positive &= invert(s, ops);
    if constexpr (keep_inverse) {
      Lane8 inverse[6] = {unit_lane[0], unit_lane[1], unit_lane[2], unit_lane[3], unit_lane[4], unit_lane[5]};
      solve_rows(ops, inverse);
      for (int r = 0; r < 6; ++r) inverse_[i].column[r] = inverse[r];
    }
    if (column.off_begin == column.off_end)
      for (int r = 0; r < 6; ++r) solution_[i][r] = s[r][6] * ops.inverse[r][6];

    const int* target = updates_.data() + column.update_begin;
    for (int q = column.off_begin; q < column.off_end; ++q) {
      Lane8* stored = off_work_[static_cast<std::size_t>(q)].column;
      Lane8 before[6], solved[6];
      for (int r = 0; r < 6; ++r) solved[r] = before[r] = with_lane_6(stored[r], rhs[r]);
      solve_rows(ops, solved);
      subtract_product(diagonal_work_[static_cast<std::size_t>(off_[static_cast<std::size_t>(q)].position)], before,
                       solved);
      // S^-1 is symmetric: B_p^T X_q = X_p^T B_q, and X_p is stored by now.
      for (int p = column.off_begin; p < q; ++p)
        subtract_product(off_work_[static_cast<std::size_t>(*target++)], off_work_[static_cast<std::size_t>(p)].column,
                         before);
      for (int r = 0; r < 6; ++r) stored[r] = solved[r];
    }
  }
  return positive;
}

}  // namespace rodsweep
