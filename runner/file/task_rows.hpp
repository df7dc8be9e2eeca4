// The rows that tasks own in a results file, read back as bytes: for checksums and comparisons. Throws Hdf5Error, and
// std::out_of_range or std::length_error where the file contradicts itself.
#pragma once

#include <cstddef>
#include <vector>

#include "runner/file/hdf5.hpp"
#include "runner/file/record.hpp"

namespace rodsweep {

/// A column and its dataset; without one where the file leaves it out.
struct StoredColumn {
  Column column;
  hid_t type;  ///< in memory
  hdf5::RowDataset dataset;
};

/// All columns outside /timing, in the order of visit_columns().
std::vector<StoredColumn> stored_columns(const hdf5::File& file);

/// Rows [first, first + count) as bytes; nothing where the dataset is left out.
void read_rows(const StoredColumn& stored, const RowRange& rows, std::vector<char>& bytes);

/// Every task's rows, as the file tells them; `count` tasks.
std::vector<Task> read_tasks(const hdf5::File& file, std::size_t count);

}  // namespace rodsweep
