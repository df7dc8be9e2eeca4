// The list of all datasets that tasks fill, with path, axes, unit, meaning and TaskRecord member (see columns.cpp).
// Used to create, check, write, read, checksum and compare them.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>
#include <variant>
#include <vector>

#include "runner/file/record.hpp"

namespace rodsweep {

/// Axes after the row: guess, tolerance, vector (3), quaternion (4), joint constraint (6: stretch-shear, then
/// bend-twist), frames of a task.
enum class Axis { guess, tolerance, xyz, wxyz, constraint, frame };

/// The values of a column in a record: [row, axes ...].
using Values = std::variant<Cells<std::int8_t>*, Cells<std::int16_t>*, Cells<std::int32_t>*, Cells<std::int64_t>*,
                            Cells<float>*, Cells<double>*>;

struct Column {
  const char* path;
  Rows rows;
  std::vector<Axis> axes;
  const char* unit;        ///< "1" for dimensionless
  const char* meaning;     ///< one line
  std::int64_t (*type)();  ///< HDF5 type of a value in memory
  std::function<Values(TaskRecord&)> values;
};

/// In the order of the file.
const std::vector<Column>& columns();

/// Sizes of the axes after the row.
std::vector<std::int64_t> row_extent(const Column& column, const AxisSizes& sizes);

/// Values in one row.
std::int64_t row_width(const Column& column, const AxisSizes& sizes);

/// Whether it may differ between runs of the same job, and so is not in the checksum.
bool is_timing(const Column& column);

/// The raw bytes of a column's values in a record.
std::string_view bytes_of(const Column& column, const TaskRecord& record);
char* data_of(const Column& column, TaskRecord& record);

}  // namespace rodsweep
