// The runs of a sweep or a training, one row of /runs each. The list of columns is in runs.cpp.
#pragma once

#include <vector>

#include "runner/file/hdf5.hpp"
#include "runner/file/layout.hpp"
#include "runner/file/provenance.hpp"

namespace rodsweep {

inline constexpr int run_rows = 64;  ///< maximum number of runs stored in a file

/// The datasets, in the order of the file.
std::vector<Field> run_fields();

/// The used rows. Columns missing in older files are skipped.
std::vector<RunRow> read_runs(const hdf5::File& file);

/// Writes a whole row, but columns missing in older files. Writes the begin last, because it marks the row as used.
void write_run(const hdf5::File& file, std::size_t row, const RunRow& run);

/// The file of a model has one row for each run, and no columns of shards, copied rows and the time left.
void create_training_runs(hid_t file, std::vector<RunRow> runs);
std::vector<RunRow> read_training_runs(hid_t file);  ///< throws Damage if a column is missing

}  // namespace rodsweep
