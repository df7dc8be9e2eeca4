// The command `pack`: a compressed copy of a results file. No MPI. Throws FileError and Hdf5Error.
#pragma once

#include <filesystem>
#include <optional>

#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct PackOptions {
  std::filesystem::path file;
  std::optional<std::filesystem::path> output;  ///< default: FILE-packed.h5 in FILE's folder
};

inline constexpr const char* pack_help =
    "All commands can read the copy, but it cannot be resumed: keep the original of an incomplete sweep. Finished\n"
    "tasks are compared with their checksums before and after. Nothing is overwritten. The copy gets its name when\n"
    "it is complete.\n\n"
    "Examples:\n"
    "  rodsweep pack results/demo.h5                                   results/demo-packed.h5\n"
    "  rodsweep pack results/demo.h5 -o /archive/demo.h5\n\n"
    "Exit codes:\n"
    "  0  packed\n"
    "  2  error in the command line or the file; nothing was written";

ExitCode execute(const PackOptions& options, Console& console);

}  // namespace rodsweep
