// The commands `status` and `info` on the file of a model. No MPI. Throws FileError and Hdf5Error.
#pragma once

#include "runner/command/command_line.hpp"
#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

ExitCode show_model_status(const StatusOptions& options, Console& console);
ExitCode show_model_info(const InfoOptions& options, Console& console);

}  // namespace rodsweep
