// What a shell needs to complete a command line of ours: commands first, then options, job files (*.json) and results
// files (*.h5), and behind `keep --` another command. Scripts to source, or to put where the shell looks for them.
#pragma once

#include <string>

#include "runner/command/command_outline.hpp"

namespace rodsweep {

std::string bash_completion(const CommandOutline& program);
std::string zsh_completion(const CommandOutline& program);   ///< with descriptions
std::string fish_completion(const CommandOutline& program);  ///< likewise

}  // namespace rodsweep
