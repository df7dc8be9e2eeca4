#include "solver/factor/multifrontal_factor.hpp"

#include <algorithm>
#include <utility>

#include "solver/factor/elimination_order.hpp"
#include "solver/factor/front_kernels.hpp"

namespace rodsweep {
namespace {

std::size_t lanes_for(std::size_t doubles) { return (doubles + 7) / 8; }

inline const Lane8& lane8_at(const double* from) { return *reinterpret_cast<const Lane8*>(from); }
inline Lane8& lane8_at(double* from) { return *reinterpret_cast<Lane8*>(from); }

/// x -= the columns of a tile times `factors`.
void subtract_columns(const double* tile, const double* factors, int columns, double* x) {
  Lane8 even[3]{}, odd[3]{};
  for (int c = 0; c < columns; c += 2)
    for (int v = 0; v < 3; ++v) {
      even[v] += lane8_at(tile + c * tile_rows + 8 * v) * factors[c];
      odd[v] += lane8_at(tile + (c + 1) * tile_rows + 8 * v) * factors[c + 1];
    }
  for (int v = 0; v < 3; ++v) lane8_at(x + 8 * v) -= even[v] + odd[v];
}

/// Six columns of `tiles` tiles that follow each other, transposed, times x.
Lane8 six_products(const double* columns, std::size_t tile_size, const double* x, int tiles) {
  Lane8 sums[6]{};
  for (int t = 0; t < tiles; ++t, columns += tile_size, x += tile_rows)
#pragma GCC unroll 3
    for (int v = 0; v < 3; ++v) {
      const Lane8 known = lane8_at(x + 8 * v);
#pragma GCC unroll 6
      for (int c = 0; c < 6; ++c) sums[c] += lane8_at(columns + c * tile_rows + 8 * v) * known;
    }
  return sum_lanes(sums);
}

/// x -= six rows of a tile, of `columns` columns, times `factors`, for one right-hand side per lane.
void subtract_rows(const double* rows, const Lane8* factors, int columns, Lane8* x) {
  Lane8 sums[6]{};
  for (int c = 0; c < columns; ++c)
#pragma GCC unroll 6
    for (int r = 0; r < 6; ++r) sums[r] += rows[c * tile_rows + r] * factors[c];
  for (int r = 0; r < 6; ++r) x[r] -= sums[r];
}

/// x -= a block, transposed, times `known`, for one right-hand side per lane.
void subtract_transposed(const double* block, const Lane8* known, Lane8* x) {
#pragma GCC unroll 6
  for (int c = 0; c < 6; ++c)
#pragma GCC unroll 6
    for (int r = 0; r < 6; ++r) x[c] -= block[c * tile_rows + r] * known[r];
}

}  // namespace

MultifrontalFactor::MultifrontalFactor(const BlockMatrix& pattern, AssemblyTree tree) : tree_(std::move(tree)) {
  tree_.find_rows(pattern);
  const std::vector<int> column_of = inverse(tree_.row);
  std::vector<int> place(tree_.row.size());
  int widest = 0;
  std::size_t tallest = 0;
  for (const Supernode& node : tree_.supernodes) {
    widest = std::max(widest, node.columns);
    tallest = std::max(tallest, node.panel_size() / at(6 * node.columns));
    const int end = node.first + node.columns;
    for (int k = node.first; k < end; ++k) place[at(k)] = k - node.first;
    for (int r = 0; r < node.row_count; ++r) place[at(tree_.rows[at(node.row_begin + r)])] = node.columns + r;
    for (int k = node.first; k < end; ++k) {
      const int own = tree_.row[at(k)];
      for (int e = pattern.row_begin(own); e < pattern.row_end(own); ++e) {
        const int i = column_of[at(pattern.column(e))];
        if (i < k) continue;
        sources_.push_back({pattern.find(pattern.column(e), own),
                            node.panel + node.block_offset(place[at(i)]) + at(6 * tile_rows * (k - node.first))});
      }
    }
    source_end_.push_back(sources_.size());
  }
  panels_.resize(lanes_for(tree_.panel_size));
  for (std::size_t i : {0, 1}) stacks_[i].resize(lanes_for(tree_.stack_size[i]));
  inverse_pivot_.resize(6 * tree_.row.size());
  solution_.resize(6 * tree_.row.size());
  pivots_.resize(lanes_for(at(tile_rows * tiles_of(widest))));
  known_.resize(lanes_for(tallest));
}

bool MultifrontalFactor::factorise(const BlockMatrix& a) {
  std::size_t source = 0;
  for (std::size_t s = 0; s < tree_.supernodes.size(); ++s) {
    const Supernode& node = tree_.supernodes[s];
    double* const first = entries(panels_) + node.panel;
    std::fill_n(first, node.panel_size(), 0.0);
    std::fill_n(update_of(node), node.update_size(), 0.0);
    for (; source < source_end_[s]; ++source) {
      const Block6& block = a.blocks[at(sources_[source].block)];
      double* const to = entries(panels_) + sources_[source].to;
      for (int c = 0; c < 6; ++c) store6(to + c * tile_rows, block.column[c]);
    }
    for (int c = node.child_begin; c < node.child_end; ++c)
      add_update(tree_.supernodes[at(tree_.children[at(c)])], node);
    const Panel panel(node, first);
    if (!panel.factorise(inverse_pivot_.data() + 6 * node.first)) return false;
    panel.subtract_square(update_of(node));
  }
  return true;
}

/// Adds U of a child to its rows in the parent's front.
void MultifrontalFactor::add_update(const Supernode& child, const Supernode& node) {
  const Panel panel(node, entries(panels_) + node.panel);
  const double* const from = update_of(child);
  double* const update = update_of(node);
  const int* const place = tree_.in_parent.data() + child.row_begin;
  for (int q = 0; q < child.row_count; ++q)
    for (int p = q; p < child.row_count; ++p) {
      const double* const source = from + update_tile(p / tile_blocks) + 6 * (p % tile_blocks) + 6 * tile_rows * q;
      const int row = place[p] - node.columns, column = place[q] - node.columns;
      double* const to =
          column < 0 ? panel.block_row(place[p]) + 6 * tile_rows * place[q]
                     : update + update_tile(row / tile_blocks) + 6 * (row % tile_blocks) + 6 * tile_rows * column;
      for (int c = 0; c < 6; ++c)
        for (int r = 0; r < 6; ++r) to[c * tile_rows + r] += source[c * tile_rows + r];
    }
}

void MultifrontalFactor::substitute(VectorX& x) {
  const auto each = [&](auto&& take) {
    for (std::size_t k = 0; k < tree_.row.size(); ++k) take(solution_.data() + 6 * k, x.data() + 6 * tree_.row[k]);
  };
  each([](double* own, double* of_x) { std::copy_n(of_x, 6, own); });
  for (const Supernode& node : tree_.supernodes) forward(node);
  for (std::size_t s = tree_.supernodes.size(); s-- > 0;) backward(tree_.supernodes[s]);
  each([](double* own, double* of_x) { std::copy_n(own, 6, of_x); });
}

/// y <- L^-1 y of the columns of a front, which updates its later rows.
void MultifrontalFactor::forward(const Supernode& node) {
  const Panel panel(node, entries(panels_) + node.panel);
  const int width = 6 * node.columns;
  double* const y = entries(pivots_);
  double* const own = solution_.data() + 6 * node.first;
  std::copy_n(own, width, y);
  std::fill(y + width, y + tile_rows * node.pivot_tiles(), 0.0);
  for (int t = 0; t < node.pivot_tiles(); ++t) {
    double* const of_tile = y + tile_rows * t;
    subtract_columns(panel.tile(t), y, tile_rows * t, of_tile);
    for (int c = tile_rows * t; c < std::min(width, tile_rows * (t + 1)); ++c) {
      const double solved = y[c] * inverse_pivot_[at(6 * node.first + c)];
      const double* const column = Panel::column(panel.tile(t), c);
      for (int v = 0; v < 3; ++v) lane8_at(of_tile + 8 * v) -= lane8_at(column + 8 * v) * solved;
      y[c] = own[c] = solved;
    }
  }
  for (int t = 0; t < node.row_tiles(); ++t) {
    alignas(64) double taken[tile_rows]{};
    subtract_columns(panel.row_tile(t), y, width, taken);
    const int* const row = tree_.rows.data() + node.row_begin + tile_blocks * t;
    for (int r = 0; r < std::min(tile_blocks, node.row_count - tile_blocks * t); ++r)
      for (int i = 0; i < 6; ++i) solution_[at(6 * row[r] + i)] += taken[6 * r + i];
  }
}

/// x <- L^-T (y - R^T x of the later rows).
void MultifrontalFactor::backward(const Supernode& node) {
  const Panel panel(node, entries(panels_) + node.panel);
  double* const own = solution_.data() + 6 * node.first;
  double* const known = entries(known_);  // solution of every row of the panel; zero until known
  std::fill_n(known, node.panel_size() / at(6 * node.columns), 0.0);
  for (int r = 0; r < node.row_count; ++r)
    std::copy_n(solution_.data() + 6 * tree_.rows[at(node.row_begin + r)], 6,
                known + tile_rows * node.pivot_tiles() + 6 * r);
  for (int block = node.columns; block-- > 0;) {
    const int t = block / tile_blocks, row = 6 * block;
    const double* const column = Panel::column(panel.tile(t), row);
    const Lane8 later =
        six_products(column, node.tile_size(), known + tile_rows * t, node.pivot_tiles() + node.row_tiles() - t);
    const double* const l = column + row % tile_rows;
    for (int c = 6; c-- > 0;) {
      double x = own[row + c] - later[c];
      for (int k = c + 1; k < 6; ++k) x -= l[c * tile_rows + k] * known[row + k];
      own[row + c] = known[row + c] = x * inverse_pivot_[at(6 * node.first + row + c)];
    }
  }
}

void MultifrontalFactor::substitute(std::vector<Lane8>& x) {
  solutions_.resize(6 * tree_.row.size());
  const auto each = [&](auto&& take) {
    for (std::size_t k = 0; k < tree_.row.size(); ++k) take(solutions_.data() + 6 * k, x.data() + 6 * tree_.row[k]);
  };
  each([](Lane8* own, Lane8* of_x) { std::copy_n(of_x, 6, own); });
  for (const Supernode& node : tree_.supernodes) forward_in_lanes(node);
  for (std::size_t s = tree_.supernodes.size(); s-- > 0;) backward_in_lanes(tree_.supernodes[s]);
  each([](Lane8* own, Lane8* of_x) { std::copy_n(own, 6, of_x); });
}

void MultifrontalFactor::forward_in_lanes(const Supernode& node) {
  const Panel panel(node, entries(panels_) + node.panel);
  Lane8* const y = solutions_.data() + 6 * node.first;
  for (int block = 0; block < node.columns; ++block) {
    Lane8* const own = y + 6 * block;
    double* const rows = panel.block_row(block);
    subtract_rows(rows, y, 6 * block, own);
    const double* const l = Panel::column(rows, 6 * block);
    for (int c = 0; c < 6; ++c) {
      own[c] *= inverse_pivot_[at(6 * (node.first + block) + c)];
      for (int r = c + 1; r < 6; ++r) own[r] -= l[c * tile_rows + r] * own[c];
    }
  }
  for (int r = 0; r < node.row_count; ++r)
    subtract_rows(panel.block_row(node.columns + r), y, 6 * node.columns,
                  solutions_.data() + 6 * tree_.rows[at(node.row_begin + r)]);
}

void MultifrontalFactor::backward_in_lanes(const Supernode& node) {
  const Panel panel(node, entries(panels_) + node.panel);
  Lane8* const x = solutions_.data() + 6 * node.first;
  for (int block = node.columns; block-- > 0;) {
    Lane8* const own = x + 6 * block;
    const auto take = [&](int local, const Lane8* known) {
      subtract_transposed(Panel::column(panel.block_row(local), 6 * block), known, own);
    };
    for (int r = 0; r < node.row_count; ++r)
      take(node.columns + r, solutions_.data() + 6 * tree_.rows[at(node.row_begin + r)]);
    for (int later = block + 1; later < node.columns; ++later) take(later, x + 6 * later);
    const double* const l = Panel::column(panel.block_row(block), 6 * block);
    for (int c = 6; c-- > 0;) {
      for (int k = c + 1; k < 6; ++k) own[c] -= l[c * tile_rows + k] * own[k];
      own[c] *= inverse_pivot_[at(6 * (node.first + block) + c)];
    }
  }
}

}  // namespace rodsweep
