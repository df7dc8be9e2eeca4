// Conversion of whole numbers to fewer bits; throws std::logic_error if they do not fit.
#pragma once

#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

namespace rodsweep {

template <class Narrow>
Narrow narrow(std::int64_t value) {
  if (value < std::numeric_limits<Narrow>::min() || value > std::numeric_limits<Narrow>::max())
    throw std::logic_error(std::to_string(value) + " does not fit into " + std::to_string(8 * sizeof(Narrow)) +
                           " bits");
  return static_cast<Narrow>(value);
}

}  // namespace rodsweep
