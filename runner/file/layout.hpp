// Every dataset of a plan's results file: path, type, extents, unit and meaning. Creating the file, its size, opening
// it and the checks of --resume all walk this one list. A dataset that would hold nothing is left out (/solves of a job
// that records summaries, /trajectories, /systems of a sweep, what has a guess axis where there are no guesses,
// contacts where no task has contact).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runner/file/hdf5.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

struct Field {
  std::string path;
  hid_t (*number)() = nullptr;       ///< hdf5::type_of<T>; none: text
  std::int64_t text_bytes = 0;       ///< length of a text
  std::vector<std::int64_t> extent;  ///< empty: a scalar
  std::string unit, meaning;
};

inline constexpr int schema_version = 1;

inline constexpr int outcome_bytes = 16;
inline constexpr int message_bytes = 240;
inline constexpr int host_bytes = 64;

/// `parameters` are plan.parameters(), which are built on demand. Throws FileError for more bytes than any file takes.
std::vector<Field> layout(const Plan& plan, const std::vector<ParameterColumn>& parameters);

Field text_field(std::string path, std::int64_t bytes, std::vector<std::int64_t> extent, std::string meaning);

template <class T>
Field number_field(std::string path, std::vector<std::int64_t> extent, std::string unit, std::string meaning) {
  return {std::move(path), hdf5::type_of<T>, 0, std::move(extent), std::move(unit), std::move(meaning)};
}

hdf5::Datatype type_of(const Field& field);

/// Bytes of the values of a dataset of a layout().
std::int64_t data_bytes(const Field& field);

/// Sixteen hexadecimal digits over what the plan fixes about the file (floating-point parameters are left out: another
/// machine may round them differently).
std::string plan_hash(const Plan& plan, const std::vector<ParameterColumn>& parameters);

}  // namespace rodsweep
