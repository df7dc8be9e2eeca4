// SplitMix64 (Steele, Lea, Flood 2014): well-mixed bits of a counter, the same on every machine.
#pragma once

#include <cmath>
#include <cstdint>

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

}  // namespace rodsweep
