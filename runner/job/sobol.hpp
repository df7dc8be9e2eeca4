// Sobol's low-discrepancy points (Sobol' 1967; direction numbers of Joe & Kuo 2008, as Boost.Random holds them) with a
// random digital shift (L'Ecuyer & Lemieux 2002): any coordinate of any point in any order, in the Gray-code order of
// Antonov & Saleev (1979), so that the first 2^k points are a net for every k and point i is the same however many are
// drawn. The shift flips the same bits in all points of a dimension: it keeps the net, moves the origin away from 0,
// and makes other sequences of other seeds.
#pragma once

#include <cstdint>
#include <vector>

namespace rodsweep {

class SobolSequence {
 public:
  static std::size_t most_dimensions();

  /// Throws std::logic_error for more than most_dimensions().
  explicit SobolSequence(std::size_t dimensions);

  /// Coordinate in [0, 1), 53 bits; index below 2^32. `shift` belongs to the dimension; 0: the plain sequence, which
  /// begins with the origin.
  double unit(std::size_t dimension, std::uint64_t index, std::uint64_t shift) const;

 private:
  std::vector<std::uint64_t> directions_;  ///< [dimension, bit of the index]
};

}  // namespace rodsweep
