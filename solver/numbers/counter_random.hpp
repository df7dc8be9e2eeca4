// Random numbers without state: a value is a pure function of (seed, counter, stream), so that any rank can draw any
// sample of any key in any order, and grid points share draws. Three rounds of the splitmix64 finaliser (Steele, Lea,
// Flood 2014); streams are FNV-1a hashes of key paths, the same on every machine.
#pragma once

#include <cstdint>
#include <string_view>

#include "solver/numbers/split_mix.hpp"

namespace rodsweep {

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
