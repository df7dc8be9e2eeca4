// What bash needs to complete a command line of ours: made from the parser's own list of commands and options.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace rodsweep {

/// A script to source: commands first, then options, job files (*.json) and results files (*.h5).
std::string bash_completion(const CLI::App& app);

}  // namespace rodsweep
