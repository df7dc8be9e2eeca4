#include "network/parameters.hpp"

#include "solver/split_mix.hpp"

namespace rodsweep {

double WeightSource::uniform() {
  const std::uint64_t bits = split_mix(state_);
  state_ += split_mix_increment;
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

}  // namespace rodsweep
