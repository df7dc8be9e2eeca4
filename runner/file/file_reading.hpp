// Opens and checks a results file, read-only, on one process without MPI.
// Throws FileError if it is missing, foreign, damaged or of another schema version.
#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "runner/file/file_error.hpp"
#include "runner/file/hdf5.hpp"

namespace rodsweep {

/// Opens a file of any kind that rodsweep made. `what`: the expected kind, for the message about a foreign file.
hdf5::File open_own(const std::filesystem::path& path, const char* what);

/// The kind of a file: "model" or the kind of its job.
std::string kind_of(const hdf5::File& file);

/// Throws FileError if the schema version is not `known`.
void check_version(const hdf5::File& file, const std::filesystem::path& path, int known);

hdf5::File open_results(const std::filesystem::path& path);

/// The error for a file that passed open_results() but has invalid contents; `reason` says why.
FileError damaged_error(const std::filesystem::path& path, const std::string& reason);

/// The reason for a damaged_error(), from an exception while reading. Messages not meant for users are replaced.
std::string damage_text(const std::exception& failure);

/// Calls work(); turns exceptions other than FileError into damaged_error().
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

/// The job in the file. Throws FileError if it does not match its checksum, which files of earlier revisions lack.
std::string stored_job_text(const hdf5::File& file, const std::filesystem::path& path);

/// The checksum of a job's text, as stored.
std::string job_checksum(const std::string& text);

/// Reads the state bytes. Throws FileError unless each is 0 or 1.
std::vector<std::uint8_t> read_states(const hdf5::File& file, const std::filesystem::path& path);

}  // namespace rodsweep
