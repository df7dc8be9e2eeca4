// Opens a results file read-only, with one process and without MPI, after checking that it is one.
// Throws FileError for what is missing, foreign, damaged or of another schema version.
#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "runner/file/file_error.hpp"
#include "runner/file/hdf5.hpp"

namespace rodsweep {

/// A file that rodsweep made, of whatever kind; `what` a foreign one is not: "results".
hdf5::File open_own(const std::filesystem::path& path, const char* what);

/// What an own file holds, "model" or the kind of the job whose results it has.
std::string kind_of(const hdf5::File& file);

/// Refuses a file that another version of rodsweep wrote in another form.
void check_version(const hdf5::File& file, const std::filesystem::path& path, int known);

/// Marks a file: its A, b and multipliers are in the joints' frames (solver/rod/linearization.hpp).
void mark_frame(hid_t file);

/// Refuses a file without that mark, of a rodsweep that measured stretch and shear in the world. `advice`: what to do.
void check_frame(const hdf5::File& file, const std::filesystem::path& path, const char* advice);

hdf5::File open_results(const std::filesystem::path& path);

/// A file that passed open_results() but does not hold what it should; `reason` says what.
FileError damaged_error(const std::filesystem::path& path, const std::string& reason);

/// The reason for a damaged_error() in what reading a file threw. What is not said for users is not repeated.
std::string damage_text(const std::exception& failure);

/// Does work(); what HDF5 or the sizes of a broken file make of it is the file's fault.
template <class Work>
auto reading(const std::filesystem::path& path, Work&& work) {
  try {
    return work();
  } catch (const FileError&) {
    throw;
  } catch (const std::exception& failure) {
    throw damaged_error(path, damage_text(failure));
  }
}

/// State bytes, 0 or 1 each.
std::vector<std::uint8_t> read_states(const hdf5::File& file, const std::filesystem::path& path);

}  // namespace rodsweep
