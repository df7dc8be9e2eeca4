// Dense kernels of a front (assembly_tree.hpp): 24 rows of a tile by the six rows of a block, for any size of
// registers, near the peak of one core.
//
//   P = L L^T,   R <- R L^-T,   U <- U - R R^T
//
// All kernels work in place and allocate nothing. `inverse_pivot` are the reciprocals of L's diagonal. Large fronts
// take many seconds: both steps can be interrupted (interruption.hpp) and then throw InterruptedComputation.
#pragma once

#include "solver/factor/assembly_tree.hpp"
#include "solver/numbers/lanes.hpp"

namespace rodsweep {

inline constexpr int tile_lanes = lane_width == 8   ? 3
                                  : lane_width == 4 ? 2
                                                    : 4;  ///< six times this many sums fit in registers
inline constexpr int strip_rows = tile_lanes * lane_width;
static_assert(tile_rows % strip_rows == 0);

inline const Lane& lane_at(const double* from) { return *reinterpret_cast<const Lane*>(from); }
inline Lane& lane_at(double* from) { return *reinterpret_cast<Lane*>(from); }

/// C -= A B^T: `depth` columns of a tile A and of six rows B of a tile; C is six columns of a tile.
inline void subtract_product(const double* __restrict a, const double* __restrict b, int depth, double* __restrict c) {
  for (int strip = 0; strip < tile_rows; strip += strip_rows) {
    Lane sum[6][tile_lanes]{};
    for (int k = 0; k < depth; ++k) {
      Lane row[tile_lanes];
#pragma GCC unroll 4
      for (int v = 0; v < tile_lanes; ++v) row[v] = lane_at(a + k * tile_rows + strip + v * lane_width);
#pragma GCC unroll 6
      for (int j = 0; j < 6; ++j) {
        const Lane factor = Lane{} + b[k * tile_rows + j];
#pragma GCC unroll 4
        for (int v = 0; v < tile_lanes; ++v) sum[j][v] += row[v] * factor;
      }
    }
#pragma GCC unroll 6
    for (int j = 0; j < 6; ++j)
#pragma GCC unroll 4
      for (int v = 0; v < tile_lanes; ++v) lane_at(c + j * tile_rows + strip + v * lane_width) -= sum[j][v];
  }
}

/// The panel of a front: a pivot block above its later rows.
class Panel {
 public:
  Panel(const Supernode& node, double* panel)
      : node_(node), tiles_(node.pivot_tiles() + node.row_tiles()), panel_(panel) {}

  double* tile(int t) const { return panel_ + at(t) * node_.tile_size(); }
  double* row_tile(int t) const { return tile(node_.pivot_tiles() + t); }
  double* block_row(int local) const { return panel_ + node_.block_offset(local); }
  static double* column(double* tile, int c) { return tile + static_cast<std::ptrdiff_t>(c) * tile_rows; }

  /// P = L L^T and R L^-T. Returns false at a pivot that is not positive; P and R are invalid then.
  bool factorise(double* inverse_pivot) const;

  /// U -= R R^T.
  void subtract_square(double* u) const;

 private:
  const Supernode& node_;
  int tiles_;  ///< of P and of R
  double* panel_;
};

}  // namespace rodsweep
