// Sobol's low-discrepancy points (Sobol' 1967; direction numbers of Joe & Kuo 2008, from Boost.Random) with a random
// digital shift (L'Ecuyer & Lemieux 2002). Any coordinate of any point can be computed in any order. Points are in the
// Gray-code order of Antonov & Saleev (1979): the first 2^k points are a net for every k, and point i does not depend
// on the number of points. The shift flips the same bits in all points of a dimension. It preserves the net, moves the
// origin away from 0, and depends on the seed.
#pragma once

#include <cstdint>
#include <vector>

namespace rodsweep {

class SobolSequence {
 public:
  static std::size_t most_dimensions();

  /// Throws std::logic_error if `dimensions` exceeds most_dimensions().
  explicit SobolSequence(std::size_t dimensions);

  /// Coordinate in [0, 1), 53 bits; index below 2^32. `shift`: one per dimension; 0: the plain sequence, which begins
  /// with the origin.
  double unit(std::size_t dimension, std::uint64_t index, std::uint64_t shift) const;

 private:
  std::vector<std::uint64_t> directions_;  ///< [dimension, bit of the index]
};

}  // namespace rodsweep
