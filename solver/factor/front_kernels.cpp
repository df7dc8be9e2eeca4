#include "solver/factor/front_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "solver/linear/interruption.hpp"

namespace rodsweep {
namespace {

constexpr int depth_at_once = 144;  // columns of a tile that fit the first cache
constexpr int tiles_at_once = 12;   // tiles of that depth that fit the second cache
constexpr int blocks_at_once = 8;   // blocks of a panel that all earlier ones update together

/// Checks for an interruption after this many products of blocks.
void look_up(std::int64_t products) {
  constexpr std::int64_t product_ns = 20;
  check_interrupted(product_ns * products);
}

/// L of a 6x6 block on the diagonal, and the reciprocals of its own diagonal.
struct Pivot {
  double l[6][6], inverse[6];

  /// `block`: its first entry in a tile. Returns false if it is not positive definite.
  bool factorise(const double* block) {
    for (int c = 0; c < 6; ++c)
      for (int r = c; r < 6; ++r) l[r][c] = block[c * tile_rows + r];
    for (int c = 0; c < 6; ++c) {
      if (!(l[c][c] > 0)) return false;
      inverse[c] = 1 / std::sqrt(l[c][c]);
      for (int r = c + 1; r < 6; ++r) l[r][c] *= inverse[c];
      for (int k = c + 1; k < 6; ++k)
        for (int r = k; r < 6; ++r) l[r][k] -= l[r][c] * l[k][c];
    }
    return true;
  }

  /// x <- x L^-T, six columns of a tile; the block's own rows become L.
  void solve(double* x) const {
    for (int strip = 0; strip < tile_rows; strip += lane_width) {
      Lane rows[6];
#pragma GCC unroll 6
      for (int c = 0; c < 6; ++c) {
        rows[c] = lane_at(x + c * tile_rows + strip);
#pragma GCC unroll 6
        for (int k = 0; k < c; ++k) rows[c] -= rows[k] * l[c][k];
        rows[c] *= inverse[c];
        lane_at(x + c * tile_rows + strip) = rows[c];
      }
    }
  }
};

}  // namespace

bool Panel::factorise(double* inverse_pivot) const {
  for (int begin = 0; begin < node_.columns; begin += blocks_at_once) {
    const int end = std::min(node_.columns, begin + blocks_at_once);
    Pivot pivots[blocks_at_once];
    for (int first = begin / tile_blocks; first < tiles_; first += tiles_at_once) {
      const int last = std::min(tiles_, first + tiles_at_once);
      for (int k = 0; k < 6 * begin; k += depth_at_once) {
        const int depth = std::min(depth_at_once, 6 * begin - k);
        for (int block = begin; block < end; ++block) {
          const double* b = column(block_row(block), k);
          for (int t = std::max(first, block / tile_blocks); t < last; ++t)
            subtract_product(column(tile(t), k), b, depth, column(tile(t), 6 * block));
        }
      }
      look_up(std::int64_t{tile_blocks} * (last - first) * (end - begin) * end);
    }
    for (int t = begin / tile_blocks; t < tiles_; ++t)
      for (int block = begin; block < end && block / tile_blocks <= t; ++block) {
        subtract_product(column(tile(t), 6 * begin), column(block_row(block), 6 * begin), 6 * (block - begin),
                         column(tile(t), 6 * block));
        Pivot& pivot = pivots[block - begin];
        if (t != block / tile_blocks) {
          pivot.solve(column(tile(t), 6 * block));
          continue;
        }
        if (!pivot.factorise(column(block_row(block), 6 * block))) return false;
        pivot.solve(column(tile(t), 6 * block));
        std::copy_n(pivot.inverse, 6, inverse_pivot + 6 * block);
        // Entries above the diagonal were computed with the rest.
        for (int c = 0; c < 6; ++c) std::fill_n(column(tile(t), 6 * block + c), 6 * (block % tile_blocks) + c, 0.0);
      }
  }
  return true;
}

void Panel::subtract_square(double* u) const {
  const int tiles = node_.row_tiles();
  for (int first = 0; first < tiles; first += tiles_at_once) {
    const int last = std::min(tiles, first + tiles_at_once);
    for (int k = 0; k < 6 * node_.columns; k += depth_at_once) {
      const int depth = std::min(depth_at_once, 6 * node_.columns - k);
      for (int block = 0; block < std::min(node_.row_count, tile_blocks * last); ++block) {
        const double* b = column(block_row(node_.columns + block), k);
        for (int t = std::max(first, block / tile_blocks); t < last; ++t)
          subtract_product(column(row_tile(t), k), b, depth, column(u + update_tile(t), 6 * block));
      }
      look_up(std::int64_t{tile_blocks} * (last - first) * std::min(node_.row_count, tile_blocks * last) * depth / 6);
    }
  }
}

}  // namespace rodsweep
