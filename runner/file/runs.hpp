// The starts of a sweep, a row of /runs each. The list of its columns is in runs.cpp.
#pragma once

#include <vector>

#include "runner/file/hdf5.hpp"
#include "runner/file/layout.hpp"
#include "runner/file/provenance.hpp"

namespace rodsweep {

inline constexpr int run_rows = 64;  ///< starts that one file remembers

/// The datasets, in the order of the file.
std::vector<Field> run_fields();

/// Rows in use. Files that are older than a column are read without it.
std::vector<RunRow> read_runs(const hdf5::File& file);

/// Writes a whole row, its begin last, which marks it as used.
void write_run(const hdf5::File& file, std::size_t row, const RunRow& run);

}  // namespace rodsweep
