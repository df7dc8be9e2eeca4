#include "runner/sweep/sobol.hpp"

#include <boost/random/sobol.hpp>

#include "solver/numbers/counter_random.hpp"

namespace rodsweep {
namespace {

constexpr std::uint32_t first_digit = 0x80000000u;

std::uint32_t reversed(std::uint32_t bits) {
  bits = (bits & 0xffff0000u) >> 16 | (bits & 0x0000ffffu) << 16;
  bits = (bits & 0xff00ff00u) >> 8 | (bits & 0x00ff00ffu) << 8;
  bits = (bits & 0xf0f0f0f0u) >> 4 | (bits & 0x0f0f0f0fu) << 4;
  bits = (bits & 0xccccccccu) >> 2 | (bits & 0x33333333u) << 2;
  return (bits & 0xaaaaaaaau) >> 1 | (bits & 0x55555555u) << 1;
}

}  // namespace

Directions sobol_directions(int dimension) {
  // The Gray code of 2^(b+1) - 1 is only bit b. Boost skips the origin, so its number n is point n + 1.
  const auto d = static_cast<std::size_t>(dimension);
  boost::random::sobol engine(d + 1);
  Directions directions{};
  for (std::size_t bit = 0; bit < directions.size(); ++bit) {
    engine.seed((std::uint64_t{2} << bit) - 2);
    engine.discard(d);
    directions[bit] = static_cast<std::uint32_t>(engine() >> 32);
  }
  return directions;
}

Directions random_directions(std::uint64_t seed, std::uint64_t stream) {
  Directions directions{};
  for (std::size_t bit = 0; bit < directions.size(); ++bit) {
    const std::uint32_t last = first_digit >> bit, before = ~(last | (last - 1));
    directions[bit] = last | (static_cast<std::uint32_t>(random_bits(seed, bit, stream)) & before);
  }
  return directions;
}

std::uint32_t digits(const Directions& directions, std::uint64_t number) {
  std::uint32_t out = 0;
  const std::uint32_t* direction = directions.data();
  for (std::uint64_t code = number ^ (number >> 1); code != 0; code >>= 1, ++direction)
    if ((code & 1) != 0) out ^= *direction;
  return out;
}

std::uint32_t scrambled(std::uint32_t digits, std::uint32_t seed) {
  std::uint32_t x = reversed(digits);  // multiplication carries from low to high bits
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return reversed(x);
}

EvenSequence::EvenSequence(std::optional<int> dimension, std::uint64_t seed, std::uint64_t stream)
    : directions_(dimension ? sobol_directions(*dimension) : random_directions(seed, stream)),
      scramble_(static_cast<std::uint32_t>(random_bits(seed, directions_.size(), stream))) {}

}  // namespace rodsweep
