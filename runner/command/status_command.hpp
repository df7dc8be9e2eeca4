// The command `status`: the progress of a sweep or a training, and where each task of a live sweep runs. No MPI.
// Throws FileError and Hdf5Error.
#pragma once

#include <filesystem>

#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct StatusOptions {
  std::filesystem::path file;
  bool json = false;
  double watch_s = 0;  ///< repeat at this interval until no run writes the file; 0: print once
};

inline constexpr const char* status_help =
    "Only reads the file, also during a run. The exit code is 0 in every state: scripts can read --json. A running\n"
    "sweep locks the file. Without file locks, it counts as running while it updates the time of the file. The\n"
    "remaining time is the run's own estimate, from the cost of the tasks that are left and the pace of the last "
    "ones.\n\n"
    "Examples:\n"
    "  rodsweep status results/demo.h5 --json | jq .pending\n"
    "  rodsweep status results/demo.h5 --watch           a line every 5 seconds until it ends";

ExitCode execute(const StatusOptions& options, Console& console);

}  // namespace rodsweep
