// The commands `status` and `info`: what a results file holds, and where it comes from; and `--version`, where the
// program does. No MPI. Throws FileError and Hdf5Error.
#pragma once

#include "runner/command/command_line.hpp"
#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

ExitCode show_status(const StatusOptions& options, Console& console);
ExitCode show_info(const InfoOptions& options, Console& console);
ExitCode show_version(Console& console);

}  // namespace rodsweep
