// The command `validate`: is a job sound? No MPI.
#pragma once

#include <filesystem>
#include <vector>

#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct ValidateOptions {
  std::vector<std::filesystem::path> jobs;
  bool later = false;  ///< files that are missing will be there when the job runs
};

inline constexpr const char* validate_help =
    "Every job is expanded in full, so what passes here is accepted by run. Nothing is computed or written.\n"
    "A model or data set that a job names must be there, or be made by another of the jobs given: results/NAME.h5 by "
    "the\n"
    "one whose name is NAME. Values in what may be the wrong unit are warned of.\n\n"
    "Examples:\n"
    "  rodsweep validate my.json\n"
    "  rodsweep validate data.json train.json use.json     the first makes what the second learns from, and so on\n"
    "  rodsweep validate --later jobs/*.json               whatever is missing will be made";

/// Says of every job whether it is sound, and goes on after one that is not. A missing file is a mistake unless one of
/// the other jobs has its name (or with `later`).
ExitCode execute(const ValidateOptions& options, Console& console);

}  // namespace rodsweep
