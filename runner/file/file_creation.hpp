// Creates the file of a sweep, complete but for its results, by one process with HDF5's ordinary driver. It is made
// under a temporary name beside `path` and gets its own name when it is whole, in one step that never replaces another
// file: two programs cannot create the same file, and one that is killed meanwhile leaves `path` free. Its blocks are
// reserved where the file system can, so that the disk does not fill up halfway. Throws FileError (exists, no space, no
// permission) and Hdf5Error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "runner/file/file_error.hpp"
#include "runner/job/plan.hpp"

namespace rodsweep {

/// Bytes that this process may still write into a folder.
using FreeSpace = std::function<std::uintmax_t(const std::filesystem::path& folder)>;
std::uintmax_t free_bytes(const std::filesystem::path& folder);

void create_results_file(const std::filesystem::path& path, const Plan& plan, const FreeSpace& free_space);

/// Bytes that the file of this plan takes.
std::int64_t file_bytes(const Plan& plan);

}  // namespace rodsweep
