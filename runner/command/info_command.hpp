// The command `info`: the content and provenance of a results file or a model. No MPI. Throws FileError and Hdf5Error.
#pragma once

#include <filesystem>

#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct InfoOptions {
  std::filesystem::path file;
  bool verify = false;
  bool job = false;  ///< print only the job's text
  bool json = false;
};

inline constexpr const char* info_help =
    "Examples:\n"
    "  rodsweep info results/demo.h5                     job, axes, and every start with its versions\n"
    "  rodsweep info results/demo.h5 --verify            are the data still what was written? (checksums)\n"
    "  rodsweep info results/demo.h5 --job > again.json  the job, as it was given";

ExitCode execute(const InfoOptions& options, Console& console);

}  // namespace rodsweep
