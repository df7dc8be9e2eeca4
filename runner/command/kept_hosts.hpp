// Which hosts can take part in a start: those that answer to mpirun's launch agent.
#pragma once

#include <filesystem>

#include "runner/terminal/console.hpp"

namespace rodsweep {

/// Asks all hosts of a file like mpirun's --hostfile at once, and writes the lines of those that answer into a file
/// beside `results`, whose path it returns. Hosts that do not are warned of. Throws FileError where none answers, or a
/// file cannot be read or written.
std::filesystem::path answering_hosts(const std::filesystem::path& hosts, const std::filesystem::path& results,
                                      Console& console);

}  // namespace rodsweep
