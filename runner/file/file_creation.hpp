// Creates the file of a sweep, complete but for its results, by one process with HDF5's ordinary driver, under a
// temporary name until it is whole (runner/file/unfinished_file.hpp). Its blocks are
// reserved where the file system can, so that the disk does not fill up halfway. Throws FileError (exists, no space, no
// permission) and Hdf5Error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "runner/file/file_error.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

/// Bytes that this process may still write into a folder.
using FreeSpace = std::function<std::uintmax_t(const std::filesystem::path& folder)>;
std::uintmax_t free_bytes(const std::filesystem::path& folder);

/// `earlier`: files that this one takes tasks from, whose /runs come first here, as many as there is room for beside
/// one more. Returns how many rows of /runs are in use.
int create_results_file(const std::filesystem::path& path, const Plan& plan, const FreeSpace& free_space,
                        const std::vector<std::filesystem::path>& earlier = {});

/// Bytes that the file of this plan takes.
std::int64_t file_bytes(const Plan& plan);

}  // namespace rodsweep
