// Random values that cover ranges evenly: a digital sequence in base 2 for each key, which depends on the seed and the
// key alone. So a sample keeps its values if other keys are drawn too, and if there are more samples.
//
// Some keys have a dimension of Sobol's sequence (Sobol' 1967; direction numbers of Joe & Kuo 2008, from Boost.Random):
// also their pairs and triples are even. The others have random direction numbers, so pairs with them are as even as
// by chance. In both, each of 2^k equal intervals contains one of the first 2^k points, for every k.
//
// Points are in the Gray-code order of Antonov & Saleev (1979). Owen's scrambling (1995) preserves the net and makes
// means unbiased; here with the hash of Laine & Karras (2011) and constants of Vegdahl (2021).
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace rodsweep {

/// For each bit of a point's number, in Gray code, the digits that it flips; the first digit is the highest bit.
using Directions = std::array<std::uint32_t, 32>;

Directions sobol_directions(int dimension);
Directions random_directions(std::uint64_t seed, std::uint64_t stream);

/// Digits of the coordinate of point `number`, below 2^32.
std::uint32_t digits(const Directions& directions, std::uint64_t number);

/// Flips each digit at random, by the digits before it.
std::uint32_t scrambled(std::uint32_t digits, std::uint32_t seed);

class EvenSequence {
 public:
  /// `stream`: of the key. Without a dimension: random directions.
  EvenSequence(std::optional<int> dimension, std::uint64_t seed, std::uint64_t stream);

  /// In [0, 1).
  double unit(std::uint64_t number) const { return scrambled(digits(directions_, number), scramble_) * 0x1p-32; }

 private:
  Directions directions_;
  std::uint32_t scramble_;
};

}  // namespace rodsweep
