// What Python takes from outside the job: here the packages of a virtual environment.
#pragma once

#include <string>

namespace rodsweep {

/// Prints a warning as the program does. One of several ranks prints it: all meet the same.
void warn(const std::string& text);

/// Warns if the environment (VIRTUAL_ENV) is not one of the embedded Python's version, which then finds no packages in
/// it.
void check_environment(const std::string& environment);

}  // namespace rodsweep
