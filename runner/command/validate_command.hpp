// The command `validate`: is a job sound? No MPI.
#pragma once

#include <filesystem>
#include <vector>

#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct ValidateOptions {
  std::vector<std::filesystem::path> jobs;
};

inline constexpr const char* validate_help =
    "Every job is expanded in full, so what passes here is accepted by run. Nothing is computed or written.\n\n"
    "Example:\n"
    "  rodsweep validate jobs/*.json";

/// Says of every job whether it is sound, and goes on after one that is not.
ExitCode execute(const ValidateOptions& options, Console& console);

}  // namespace rodsweep
