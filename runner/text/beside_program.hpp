// Files that come with the program.
#pragma once

#include <filesystem>
#include <initializer_list>

namespace rodsweep {

/// The first of these paths, relative to the folder of this program, that exists; empty if none does: the places of a file
/// in an installation and in the source tree.
std::filesystem::path beside_program(std::initializer_list<std::filesystem::path> places);

}  // namespace rodsweep
