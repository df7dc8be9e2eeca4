// What to type next: a script of analysis/ on a file that was just made.
#pragma once

#include <filesystem>
#include <string>

namespace rodsweep {

/// "/usr/bin/python3 analysis/summary.py results/demo.h5", the script being that of the source tree or installation
/// that this program belongs to, as typed from here.
std::string script_line(const std::string& script, const std::filesystem::path& file);

}  // namespace rodsweep
