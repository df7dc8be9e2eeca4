#include "runner/job/sobol.hpp"

#include <boost/random/sobol.hpp>
#include <stdexcept>

namespace rodsweep {
namespace {

constexpr std::size_t index_bits = 32;

}  // namespace

std::size_t SobolSequence::most_dimensions() { return boost::random::default_sobol_table::max_dimension; }

SobolSequence::SobolSequence(std::size_t dimensions) : directions_(dimensions * index_bits) {
  if (dimensions > most_dimensions()) throw std::logic_error("SobolSequence: too many dimensions");
  if (dimensions == 0) return;
  // Point i is the exclusive or of the direction numbers of the bits of i's Gray code. The Gray code of 2^(b+1) - 1 is
  // only bit b. Boost skips the origin, so its number n is point n + 1.
  boost::random::sobol engine(dimensions);
  for (std::size_t bit = 0; bit < index_bits; ++bit) {
    engine.seed((std::uint64_t{2} << bit) - 2);
    for (std::size_t d = 0; d < dimensions; ++d) directions_[d * index_bits + bit] = engine();
  }
}

double SobolSequence::unit(std::size_t dimension, std::uint64_t index, std::uint64_t shift) const {
  const std::uint64_t* direction = directions_.data() + dimension * index_bits;
  std::uint64_t bits = shift;
  for (std::uint64_t code = index ^ (index >> 1); code != 0; code >>= 1, ++direction)
    if ((code & 1) != 0) bits ^= *direction;
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

}  // namespace rodsweep
