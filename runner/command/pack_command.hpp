// The command `pack`: a compressed copy of a results file. No MPI. Throws FileError and Hdf5Error.
#pragma once

#include <filesystem>
#include <optional>

#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct PackOptions {
  std::filesystem::path file;
  std::optional<std::filesystem::path> output;  ///< default: FILE's name with "-packed", beside it
};

ExitCode pack_file(const PackOptions& options, Console& console);

}  // namespace rodsweep
