// The plan of a multifrontal factorisation (Duff & Reid 1983): columns of L with the same rows form a supernode, and
// every supernode is a dense front,
//
//   [ P  .  ]   P: its columns, `columns` block columns wide         (the pivots)
//   [ R  U  ]   R: their later rows, U: their update of the rest     (added to the parent's front)
//
// A child is merged into its parent if that adds few zeros to the parent's rows: small fronts cost more than these
// zeros. Siblings are ordered so that pending updates need the least memory (Liu 1986). Updates are kept on two stacks,
// by the parity of their depth, so that a parent's U does not overlap those of its children.
//
// P, R and U are stored in tiles of four block rows: 24 entries per column, column after column. P and R each begin
// with a new tile, the last tile is padded with zeros, and only the lower triangle of U's tiles is stored.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "solver/factor/elimination_tree.hpp"

namespace rodsweep {

inline constexpr int tile_blocks = 4, tile_rows = 6 * tile_blocks;

inline constexpr int tiles_of(int block_rows) { return (block_rows + tile_blocks - 1) / tile_blocks; }

/// Offset of tile t of a front's U. It has the columns of tiles 0 .. t.
inline constexpr std::size_t update_tile(int t) { return at(tile_rows) * tile_rows * (at(t) * (t + 1) / 2); }

struct Supernode {
  int first, columns;          ///< block columns of L
  int parent;                  ///< -1 for a root
  int row_begin, row_count;    ///< R: entries of AssemblyTree::rows, and of ::in_parent
  int child_begin, child_end;  ///< entries of AssemblyTree::children
  std::size_t panel;           ///< offset of its panel in the factor
  std::size_t update;          ///< offset of U on its stack
  int stack;                   ///< 0 or 1

  int pivot_tiles() const { return tiles_of(columns); }
  int row_tiles() const { return tiles_of(row_count); }
  /// Offset in the panel of a block row of the front, P's first.
  std::size_t block_offset(int local) const {
    const int of = local < columns ? local : local - columns + tile_blocks * pivot_tiles();
    return tile_size() * at(of / tile_blocks) + at(6 * (of % tile_blocks));
  }
  std::size_t tile_size() const { return at(6 * tile_rows) * at(columns); }
  std::size_t panel_size() const { return tile_size() * at(pivot_tiles() + row_tiles()); }
  std::size_t update_size() const { return update_tile(row_tiles()); }
};

class AssemblyTree {
 public:
  /// Fronts without their rows, which suffices for the cost and the memory.
  explicit AssemblyTree(const EliminationTree& tree);

  /// Finds the rows of all fronts; `pattern` is that of the elimination tree.
  void find_rows(const BlockMatrix& pattern);

  std::vector<Supernode> supernodes;  ///< children first
  std::vector<int> row;               ///< block row of A of every column of L
  std::vector<int> children;
  std::vector<int> rows;       ///< rows of R as columns of L, ascending
  std::vector<int> in_parent;  ///< their places in the parent's front: in P if < `columns`, else in R

  std::size_t panel_size = 0;               ///< doubles
  std::array<std::size_t, 2> stack_size{};  ///< doubles
  /// Memory of a factor: panels and stacks.
  double bytes() const {
    return static_cast<double>(sizeof(double)) * static_cast<double>(panel_size + stack_size[0] + stack_size[1]);
  }
};

}  // namespace rodsweep
