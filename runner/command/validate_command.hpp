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
    "Every job is expanded in full, so what passes here is accepted by run. Nothing is computed or written.\n"
    "A model or data set that a job names must be there, or be made by another of the jobs given: results/NAME.h5 by "
    "the\n"
    "one whose name is NAME. Values in what may be the wrong unit are warned of.\n\n"
    "Examples:\n"
    "  rodsweep validate my.json\n"
    "  rodsweep validate data.json train.json use.json     the first makes what the second learns from, and so on\n"
    "  rodsweep validate --later jobs/*.json               whatever is missing will be made";

/// Reports whether each job is valid; continues after an invalid one. A missing file is an error unless another given
/// job makes it, or `later` is set.
ExitCode execute(const ValidateOptions& options, Console& console);

}  // namespace rodsweep
