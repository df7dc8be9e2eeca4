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
    "Reads only, also while the sweep writes. The exit code is 0 whatever the state: scripts read --json.\n"
    "Whether a sweep runs is known by its lock on the file, which dies with it, or where there are no locks by its\n"
    "heartbeat: it renews the file's time every 5 seconds. The time left is for tasks as long as those so far: long\n"
    "ones come first.\n\n"
    "Examples:\n"
    "  rodsweep status results/demo.h5 --json | jq .pending\n"
    "  rodsweep status results/demo.h5 --watch           a line every 5 seconds until it ends";

ExitCode execute(const StatusOptions& options, Console& console);

}  // namespace rodsweep
