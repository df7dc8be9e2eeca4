// Every dataset of a plan's results file: path, type, extents, unit and meaning. Creating the file, its size, opening
// it and the checks of --resume all walk this one list. A dataset that would hold nothing is left out (/solves of a job
// that records summaries, /trajectories, /systems of a sweep, what has a guess axis where there are no guesses,
// contacts where no task has contact).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runner/file/hdf5.hpp"
#include "runner/file/record.hpp"
#include "runner/job/plan.hpp"

namespace rodsweep {

enum class Element { int8, uint8, int16, int32, int64, uint64, float32, float64, text };

struct Field {
  std::string path;
  Element element = Element::float64;
  std::int64_t text_bytes = 0;       ///< length of Element::text
  std::vector<std::int64_t> extent;  ///< empty: a scalar
  std::string unit, meaning;
};

inline constexpr int schema_version = 1;

inline constexpr int run_rows = 64;  ///< rows of /runs: starts that one file remembers
inline constexpr int outcome_bytes = 16;
inline constexpr int message_bytes = 240;
inline constexpr int host_bytes = 64;

template <class T>
constexpr Element element_of() {
  if constexpr (std::is_same_v<T, std::int8_t>)
    return Element::int8;
  else if constexpr (std::is_same_v<T, std::uint8_t>)
    return Element::uint8;
  else if constexpr (std::is_same_v<T, std::int16_t>)
    return Element::int16;
  else if constexpr (std::is_same_v<T, std::int32_t>)
    return Element::int32;
  else if constexpr (std::is_same_v<T, std::int64_t>)
    return Element::int64;
  else if constexpr (std::is_same_v<T, std::uint64_t>)
    return Element::uint64;
  else if constexpr (std::is_same_v<T, float>)
    return Element::float32;
  else {
    static_assert(std::is_same_v<T, double>, "no element for this");
    return Element::float64;
  }
}

/// `parameters` are plan.parameters(), which are built on demand.
std::vector<Field> layout(const Plan& plan, const std::vector<ParameterColumn>& parameters);

hdf5::Datatype type_of(const Field& field);

/// Bytes of a dataset's values.
std::int64_t data_bytes(const Field& field);

/// Sixteen hexadecimal digits over what the plan fixes about the file (floating-point parameters are left out: another
/// machine may round them differently).
std::string plan_hash(const Plan& plan, const std::vector<ParameterColumn>& parameters);

}  // namespace rodsweep
