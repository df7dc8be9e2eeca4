// The command `validate`: checks jobs. No MPI.
#pragma once

#include <filesystem>
#include <vector>

#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct ValidateOptions {
  std::vector<std::filesystem::path> jobs;
  bool later = false;  ///< accept missing files; they must exist when the job runs
};

inline constexpr const char* validate_help =
    "Every job is expanded in full: `run` accepts jobs that pass. Nothing is computed or written. Models and data\n"
    "sets of a job must exist, or another given job must make them (the job named NAME makes results/NAME.h5). A\n"
    "warning is printed for values that may be in the wrong unit.\n\n"
    "Examples:\n"
    "  rodsweep validate my.json\n"
    "  rodsweep validate data.json train.json use.json     each job uses the file of the one before\n"
    "  rodsweep validate --later jobs/*.json               accepts missing models and data sets";

/// Reports whether each job is valid; continues after an invalid one. A missing file is an error unless another given
/// job makes it, or `later` is set.
ExitCode execute(const ValidateOptions& options, Console& console);

}  // namespace rodsweep
