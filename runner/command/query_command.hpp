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

inline constexpr const char* query_help =
    "A condition is COLUMN, one of = != < <= > >= ~ (contains), and a value; = and != take several values with commas\n"
    "between, and of numbers ranges LOW:HIGH, LOW: or :HIGH, ends included. All must be met. What is not there (a key\n"
    "of another scene, a result of a pending task) meets none.\n"
    "Columns are keys of the job (scene.segments), state (done, pending), outcome, message, counts and ratios of a\n"
    "guess (cg_ratio.LABEL, at another tolerance cg_ratio.LABEL@1e-4), times (elapsed_s) and more: --columns help.\n"
    "Quote < and > against the shell. Reads only, also while the sweep writes.\n\n"
    "Examples:\n"
    "  rodsweep query results/demo.h5                                  every task: what is swept, outcome, CG ratios\n"
    "  rodsweep query results/demo.h5 state=done 'outcome!=ok' --columns task,outcome,message\n"
    "  rodsweep query results/demo.h5 scene.type=helix 'scene.segments>=75' --sort cg_ratio.quadratic --limit 5\n"
    "  rodsweep query results/demo.h5 --csv >tasks.csv\n"
    "  rodsweep query results/demo.h5 'cg_ratio.previous@1e-4>1' --json | jq '.[].task'\n\n"
    "Exit codes:\n"
    "  0  read, whether tasks were found or not\n"
    "  2  the command line or the file is at fault";

ExitCode execute(const QueryOptions& options, Console& console);

}  // namespace rodsweep
