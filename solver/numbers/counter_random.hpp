// Random numbers: SplitMix64 (Steele, Lea, Flood 2014), well-mixed bits of a counter, the same on every machine, as a
// sequence from a seed; and numbers without state: a value is a pure function of (seed, counter, stream), so that any rank can draw any
// sample of any key in any order, and grid points share draws. Three rounds of SplitMix64; streams are FNV-1a hashes of key paths, the same on every machine.
#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>

#include "solver/numbers/types.hpp"

namespace rodsweep {

/// The increment of the counter from one number to the next.
inline constexpr std::uint64_t split_mix_increment = 0x9e3779b97f4a7c15u;

/// The number after the counter `z`.
inline std::uint64_t split_mix(std::uint64_t z) {
  z += split_mix_increment;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/// The sequence of numbers from a seed.
class SplitMix {
 public:
  explicit SplitMix(std::uint64_t seed) : state_(seed) {}

  double uniform() {  ///< in [0, 1)
    const std::uint64_t bits = split_mix(state_);
    state_ += split_mix_increment;
    return static_cast<double>(bits >> 11) * 0x1p-53;
  }

  double normal() {  ///< of mean 0 and deviation 1 (Box and Muller 1958)
    const double size = std::sqrt(-2 * std::log(1 - uniform()));
    return size * std::cos(2 * pi * uniform());
  }

 private:
  std::uint64_t state_;
};

inline std::uint64_t random_stream(std::string_view key_path) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : key_path) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

inline std::uint64_t random_bits(std::uint64_t seed, std::uint64_t counter, std::uint64_t stream) {
  return split_mix(split_mix(split_mix(seed) ^ stream) ^ counter);
}

/// Uniform in [0, 1), 53 bits.
inline double random_unit(std::uint64_t seed, std::uint64_t counter, std::uint64_t stream) {
  return static_cast<double>(random_bits(seed, counter, stream) >> 11) * 0x1p-53;
}

}  // namespace rodsweep
