#include "runner/job/counter_random.hpp"

#include "solver/numbers/split_mix.hpp"

namespace rodsweep {

std::uint64_t random_stream(std::string_view key_path) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : key_path) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

std::uint64_t random_bits(std::uint64_t seed, std::uint64_t counter, std::uint64_t stream) {
  return split_mix(split_mix(split_mix(seed) ^ stream) ^ counter);
}

double random_unit(std::uint64_t seed, std::uint64_t counter, std::uint64_t stream) {
  return static_cast<double>(random_bits(seed, counter, stream) >> 11) * 0x1p-53;
}

}  // namespace rodsweep
