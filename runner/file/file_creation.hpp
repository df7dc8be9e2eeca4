// Creates the file of a sweep, complete except for the results, on one process with HDF5's default driver. The file has
// a temporary name until it is complete (runner/file/unfinished_file.hpp). Its blocks are reserved if the file system
// supports this, so that the disk can't become full during the sweep. Throws FileError (exists, no space, no
// permission) and Hdf5Error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "runner/file/file_error.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

/// Bytes that this process may still write to a folder.
using FreeSpace = std::function<std::uintmax_t(const std::filesystem::path& folder)>;
std::uintmax_t free_bytes(const std::filesystem::path& folder);

/// `earlier`: files whose tasks are copied. Their /runs come first, as far as they fit with one row left for this run.
/// Returns the number of used rows of /runs.
int create_results_file(const std::filesystem::path& path, const Plan& plan, const FreeSpace& free_space,
                        const std::vector<std::filesystem::path>& earlier = {});

/// Size of the file of this plan.
std::int64_t file_bytes(const Plan& plan);

}  // namespace rodsweep
