// A command that is a program of its own: `rodsweep query FILE` starts `rodsweep-query FILE`, as git does for commands
// that it does not have. It is looked for beside this program, then as a script of a source tree (build/../analysis/),
// then on PATH.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct ExternalCommand {
  std::string name;                ///< "query"
  std::vector<std::string> words;  ///< its arguments
  std::string unknown;             ///< what to print if there is no such program
};

/// Empty: there is none. `program`: the path of this one; `path`: as the environment variable PATH.
std::filesystem::path find_command(const std::string& name, const std::filesystem::path& program,
                                   const std::string& path);

/// Does not return if the program starts.
ExitCode execute(const ExternalCommand& command, Console& console);

}  // namespace rodsweep
