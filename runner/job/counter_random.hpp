// Random numbers without state: a value is a pure function of (seed, counter, stream), so that any rank can draw any
// sample of any key in any order, and grid points share draws. Three rounds of the splitmix64 finaliser (Steele, Lea,
// Flood 2014); streams are FNV-1a hashes of key paths, the same on every machine.
#pragma once

#include <cstdint>
#include <string_view>

namespace rodsweep {

std::uint64_t random_stream(std::string_view key_path);

std::uint64_t random_bits(std::uint64_t seed, std::uint64_t counter, std::uint64_t stream);

/// Uniform in [0, 1), 53 bits.
double random_unit(std::uint64_t seed, std::uint64_t counter, std::uint64_t stream);

}  // namespace rodsweep
