// A command that is a separate program: `rodsweep query FILE` starts `rodsweep-query FILE`, as git does for unknown
// commands. Search order: the folder of this program, the scripts of a source tree (build/../analysis/), PATH.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct ExternalCommand {
  std::string name;                ///< "query"
  std::vector<std::string> words;  ///< the arguments
  std::string unknown;             ///< the message if the program is not found
};

/// Empty if not found. `program`: the path of this program; `path`: formatted like the environment variable PATH.
std::filesystem::path find_command(const std::string& name, const std::filesystem::path& program,
                                   const std::string& path);

/// Does not return if the program starts.
ExitCode execute(const ExternalCommand& command, Console& console);

}  // namespace rodsweep
