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
    "  rodsweep info results/demo.h5                     job, axes, and all runs with versions\n"
    "  rodsweep info results/demo.h5 --verify            compares the data with their checksums\n"
    "  rodsweep info results/demo.h5 --job > again.json  writes the job of the results";

ExitCode execute(const InfoOptions& options, Console& console);

}  // namespace rodsweep
