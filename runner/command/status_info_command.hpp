// The commands `status` and `info`: how far a results file or a training is, what it holds, and where it comes from. No
// MPI. Throws FileError and Hdf5Error.
#pragma once

#include <filesystem>

#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct StatusOptions {
  std::filesystem::path file;
  bool json = false;
};

struct InfoOptions {
  std::filesystem::path file;
  bool verify = false;
  bool job = false;  ///< its text alone
  bool json = false;
};

inline constexpr const char* status_help =
    "Reads only, also while the sweep writes. The exit code is 0 whatever the state: scripts read --json.\n\n"
    "Example:\n"
    "  rodsweep status results/demo.h5 --json | jq .pending";

inline constexpr const char* info_help =
    "Examples:\n"
    "  rodsweep info results/demo.h5                     job, axes, and every start with its versions\n"
    "  rodsweep info results/demo.h5 --verify            are the data still what was written? (checksums)\n"
    "  rodsweep info results/demo.h5 --job > again.json  the job, as it was given";

ExitCode execute(const StatusOptions& options, Console& console);
ExitCode execute(const InfoOptions& options, Console& console);

}  // namespace rodsweep
