#include "runner/job/counter_random.hpp"

namespace rodsweep {
namespace {

std::uint64_t splitmix64(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

}  // namespace

std::uint64_t random_stream(std::string_view key_path) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : key_path) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

std::uint64_t random_bits(std::uint64_t seed, std::uint64_t counter, std::uint64_t stream) {
  return splitmix64(splitmix64(splitmix64(seed) ^ stream) ^ counter);
}

double random_unit(std::uint64_t seed, std::uint64_t counter, std::uint64_t stream) {
  return static_cast<double>(random_bits(seed, counter, stream) >> 11) * 0x1p-53;
}

}  // namespace rodsweep
