// Which hosts can take part in a start: those that answer to mpirun's launch agent.
#pragma once

#include <filesystem>

#include "runner/terminal/console.hpp"

namespace rodsweep {

/// Asks all hosts of a file like mpirun's --hostfile at once. Returns that file where all answer; else hosts that do
/// not are warned of, and the lines of the others written into a file beside `results`, whose path it returns: an empty
/// one where none answers or the file cannot be written, which may pass. Throws FileError where `hosts` cannot be read.
std::filesystem::path answering_hosts(const std::filesystem::path& hosts, const std::filesystem::path& results,
                                      Console& console);

}  // namespace rodsweep
