// The command `query`: the tasks of a results file that meet some conditions, as a table, CSV or JSON. No MPI.
// Throws FileError and Hdf5Error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct QueryOptions {
  enum class Format { table, csv, json };
  std::filesystem::path file;
  std::vector<std::string> conditions;  ///< runner/command/query_condition.hpp; all must be met
  std::vector<std::string> columns;     ///< names, or lists of them with commas between; empty: a choice of ours
  std::string sort;                     ///< a column; empty: by task
  bool descending = false;
  std::optional<std::int64_t> limit;  ///< at most so many rows
  Format format = Format::table;
};

ExitCode query_tasks(const QueryOptions& options, Console& console);

}  // namespace rodsweep
