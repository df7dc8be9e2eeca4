// All datasets of a plan's results file: path, type, extents, unit and meaning. Used to create and open the file, to
// compute its size and to check it for --resume. Empty datasets are left out: for example /solves of a job that records
// summaries, /systems of a sweep, those with a guess axis without guesses, and those of contacts without contact.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runner/file/hdf5.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

struct Field {
  std::string path;
  hid_t (*number)() = nullptr;       ///< hdf5::type_of<T>; null: text
  std::int64_t text_bytes = 0;       ///< length of a text
  std::vector<std::int64_t> extent;  ///< empty: a scalar
  std::string unit, meaning;
};

inline constexpr int schema_version = 2;

inline constexpr int outcome_bytes = 16;
inline constexpr int message_bytes = 240;
inline constexpr int host_bytes = 64;

/// `parameters`: plan.parameters(), which are built on demand. Throws FileError if the size exceeds any file system.
std::vector<Field> layout(const Plan& plan, const std::vector<ParameterColumn>& parameters);

Field text_field(std::string path, std::int64_t bytes, std::vector<std::int64_t> extent, std::string meaning);

template <class T>
Field number_field(std::string path, std::vector<std::int64_t> extent, std::string unit, std::string meaning) {
  return {std::move(path), hdf5::type_of<T>, 0, std::move(extent), std::move(unit), std::move(meaning)};
}

hdf5::Datatype type_of(const Field& field);

/// Bytes of a dataset's values.
std::int64_t data_bytes(const Field& field);

/// A hash of the plan, sixteen hexadecimal digits. Floating-point parameters are left out, because other machines may
/// round them differently.
std::string plan_hash(const Plan& plan, const std::vector<ParameterColumn>& parameters);

}  // namespace rodsweep
