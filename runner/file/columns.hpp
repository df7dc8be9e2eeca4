// The one description of every dataset that tasks fill: its path, axes, unit, meaning and place in a TaskRecord.
// Creation, size check, writing, reading, checksums and comparisons walk the list, which columns.cpp says.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "runner/file/record.hpp"

namespace rodsweep {

/// Axes after the row: guess, tolerance, the three components of a vector, four of a quaternion, the six of a joint's
/// constraint (stretch-shear, then bend-twist), frames of a task.
enum class Axis { guess, tolerance, xyz, wxyz, constraint, frame };

/// The values of a column in a record: [row, axes ...].
using Values = std::variant<std::vector<std::int8_t>*, std::vector<std::int16_t>*, std::vector<std::int32_t>*,
                            std::vector<std::int64_t>*, std::vector<float>*, std::vector<double>*>;

struct Column {
  const char* path;
  Rows rows;
  std::vector<Axis> axes;
  const char* unit;        ///< "1" for dimensionless
  const char* meaning;     ///< one line
  std::int64_t (*type)();  ///< HDF5's handle to the type of a value in memory
  Values (*values)(TaskRecord&);
};

/// In the order of the file.
const std::vector<Column>& columns();

/// Sizes of the axes after the row.
std::vector<std::int64_t> row_extent(const Column& column, const AxisSizes& sizes);

/// Values in one row.
std::int64_t row_width(const Column& column, const AxisSizes& sizes);

/// Is its first axis after the row that of the guesses?
bool has_guesses(const Column& column);

/// Does it hold what may differ between two runs of the same job, and is in no checksum?
bool is_timing(const Column& column);

/// A column's values in a record, their type put aside.
std::string_view bytes_of(const Column& column, const TaskRecord& record);
char* data_of(const Column& column, TaskRecord& record);

/// The value at `index` in words.
std::string text_of(const Column& column, const TaskRecord& record, std::size_t index);

}  // namespace rodsweep
