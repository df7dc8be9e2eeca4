#include "solver/factor/block_elimination.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solver/factor/elimination_order.hpp"
#include "solver/linear/block_kernels.hpp"

namespace rodsweep {
namespace {

/// X^T b, from the rows of X.
inline Lane8 combined(const Block6& x, const Lane8& b) {
  Lane8 sum = x.column[0] * b[0];
#pragma GCC unroll 6
  for (int r = 1; r < 6; ++r) sum += x.column[r] * b[r];
  return sum;
}

// From the rows of X, for one right-hand side per lane:

/// X^T b + y.
inline void add_transposed_product(const Block6& x, const Lane8 (&b)[6], Lane8 (&y)[6]) {
#pragma GCC unroll 6
  for (int r = 0; r < 6; ++r)
#pragma GCC unroll 6
    for (int c = 0; c < 6; ++c) y[c] += x.column[r][c] * b[r];
}

/// X b + y.
inline void add_product(const Block6& x, const Lane8* b, Lane8 (&y)[6]) {
#pragma GCC unroll 6
  for (int c = 0; c < 6; ++c) {
    const Lane8 of = b[c];
#pragma GCC unroll 6
    for (int r = 0; r < 6; ++r) y[r] += x.column[r][c] * of;
  }
}

inline bool is_zero(const Lane8 (&b)[6]) {
  const Lane8 sum = (b[0] * b[0] + b[1] * b[1]) + (b[2] * b[2] + b[3] * b[3]) + (b[4] * b[4] + b[5] * b[5]);
  return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7])) == 0;
}

}  // namespace

BlockElimination::BlockElimination(const BlockMatrix& pattern, const std::vector<int>& order) {
  const std::size_t n = order.size();
  const std::vector<int> rows(order.rbegin(), order.rend()), position = inverse(rows);

  // The later neighbours of every column: those in A, and those of the columns whose first later neighbour it is.
  std::vector<std::vector<int>> children(n);
  std::vector<int> seen_by(n, -1), later;
  for (std::size_t i = 0; i < n; ++i) {
    const int row = rows[i];
    later.clear();
    const auto see = [&](int j) {
      if (j > static_cast<int>(i) && std::exchange(seen_by[at(j)], static_cast<int>(i)) != static_cast<int>(i))
        later.push_back(j);
    };
    for (int k = pattern.row_begin(row); k < pattern.row_end(row); ++k) see(position[at(pattern.column(k))]);
    for (const int child : children[i]) {
      const Column& of = columns_[at(child)];
      for (int q = of.off_begin; q < of.off_end; ++q) see(off_[at(q)].position);
    }
    std::sort(later.begin(), later.end());
    if (!later.empty()) children[at(later.front())].push_back(static_cast<int>(i));
    const int begin = static_cast<int>(off_.size());
    for (const int p : later) {
      // Row r of B = A_kp is column r of A_pk.
      const int source = pattern.find(rows[at(p)], row);
      off_.push_back({p, source, false, false});
    }
    columns_.push_back({row, begin, static_cast<int>(off_.size()), 0, pattern.diagonal(row), false});
  }
  list_updates();
  diagonal_work_.resize(n);
  off_work_.resize(off_.size());
  solution_.resize(n);
}

void BlockElimination::list_updates() {
  std::vector<int> entry_of(columns_.size());  // of a row in the column that is updated
  for (Column& column : columns_) {
    const int count = column.off_end - column.off_begin;
    column.update_begin = static_cast<int>(updates_.size());
    updates_.resize(updates_.size() + at(count) * at(std::max(0, count - 1)) / 2);
    for (int p = 0; p < count; ++p) {
      Off& off = off_[at(column.off_begin + p)];
      Column& later = columns_[at(off.position)];
      off.first = !later.updated;
      later.updated = true;
      for (int e = later.off_begin; e < later.off_end; ++e) entry_of[at(off_[at(e)].position)] = e;
      for (int q = p + 1; q < count; ++q) {
        const int entry = entry_of[at(off_[at(column.off_begin + q)].position)];
        updates_[at(column.update_begin + q * (q - 1) / 2 + p)] = {entry, !off_[at(entry)].updated};
        off_[at(entry)].updated = true;
      }
    }
  }
}

SolveOutcome BlockElimination::solve(const BlockMatrix& a, const VectorX& b, VectorX& x) {
  const bool positive = eliminate<false>(a, b.data());
  for (std::size_t i = columns_.size(); i-- > 0;) {
    const Column& column = columns_[i];
    if (column.off_begin < column.off_end) {
      Lane8 terms[6]{};
      Lane8 keep = Lane8{1, 1, 1, 1, 1, 1, 1, 0};  // lane 6 of every X_p holds y: add it once
      for (int p = column.off_begin; p < column.off_end; ++p) {
        const Block6& off = off_work_[at(p)];
        const Lane8 known = keep * solution_[at(off_[at(p)].position)];
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

bool BlockElimination::factorise(const BlockMatrix& a) {
  inverse_.resize(columns_.size());
  return eliminate<true>(a, nullptr);
}

void BlockElimination::substitute(VectorX& x) {
  for (std::size_t i = 0; i < columns_.size(); ++i) solution_[i] = load6(x.data() + 6 * columns_[i].row);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Column& column = columns_[i];
    const Lane8 b = solution_[i];
    for (int p = column.off_begin; p < column.off_end; ++p)
      solution_[at(off_[at(p)].position)] -= combined(off_work_[at(p)], b);
    solution_[i] = combined(inverse_[i], b);
  }
  for (std::size_t i = columns_.size(); i-- > 0;) {
    const Column& column = columns_[i];
    Lane8 terms[6]{};
    for (int p = column.off_begin; p < column.off_end; ++p)
      for (int r = 0; r < 6; ++r) terms[r] += off_work_[at(p)].column[r] * solution_[at(off_[at(p)].position)];
    if (column.off_begin < column.off_end) solution_[i] -= sum_lanes(terms);
    store6(x.data() + 6 * column.row, solution_[i]);
  }
}

void BlockElimination::substitute(std::vector<Lane8>& x) {
  const auto rows_of = [&x](const Column& column) { return x.data() + 6 * static_cast<std::ptrdiff_t>(column.row); };
  const auto later = [&](int p) { return rows_of(columns_[at(off_[at(p)].position)]); };
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Column& column = columns_[i];
    Lane8 b[6];
    std::copy_n(rows_of(column), 6, b);
    if (is_zero(b)) continue;  // few rows are loaded
    for (int p = column.off_begin; p < column.off_end; ++p) {
      Lane8 product[6]{};
      add_transposed_product(off_work_[at(p)], b, product);
      for (int r = 0; r < 6; ++r) later(p)[r] -= product[r];
    }
    Lane8 solved[6]{};
    add_transposed_product(inverse_[i], b, solved);  // S^-1 is symmetric
    std::copy_n(solved, 6, rows_of(column));
  }
  for (std::size_t i = columns_.size(); i-- > 0;) {
    const Column& column = columns_[i];
    Lane8 known[6]{};
    for (int p = column.off_begin; p < column.off_end; ++p) add_product(off_work_[at(p)], later(p), known);
    for (int r = 0; r < 6; ++r) rows_of(column)[r] -= known[r];
  }
}

template <bool keep_inverse>
bool BlockElimination::eliminate(const BlockMatrix& a, const double* b) {
  bool positive = true;
  const auto block_of = [&](int source) -> const Block6& {
    static constexpr Block6 zero{};
    return source < 0 ? zero : a.blocks[at(source)];
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
      const Off& off = off_[at(q)];
      Block6& x = off_work_[at(q)];
      const Block6& before = off.updated ? x : block_of(off.source);
      // S^-1 is symmetric: B_p^T X_q = X_p^T B_q, and X_p is stored by now.
      for (int p = column.off_begin; p < q; ++p, ++update) {
        Block6& target = off_work_[at(update->target)];
        subtract_product(update->first ? block_of(off_[at(update->target)].source) : target, off_work_[at(p)], before,
                         target);
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
      const auto later = at(off.position);
      Block6& diagonal = diagonal_work_[later];
      subtract_product(off.first ? block_of(columns_[later].diagonal_source) : diagonal, w, u, diagonal);
    }
  }
  return positive;
}

}  // namespace rodsweep
