// Locks on a results file while a run writes it. The kernel releases them when the owner dies.
//
// Against a second run: an open-file-description lock (fcntl) on a byte far behind the end of the file, where there is
// no data and no other lock. Works on NFS from version 4 on. Against other programs: the shared lock (flock) that HDF5
// asks for when it opens a file for reading, so that it refuses to open the file for writing. Neither has an effect on
// file systems without locks.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

#include "runner/file/durable.hpp"

namespace rodsweep {

class FileLock {
 public:
  FileLock() = default;
  /// Throws FileError if another run holds the lock, or another program has the file open for writing.
  explicit FileLock(const std::filesystem::path& path);

  bool held() const { return held_; }  ///< against a second run; false: the file system has no locks

  /// Whether a run on any host holds the lock; none if unknown.
  static std::optional<bool> is_held(const std::filesystem::path& path);

 private:
  Descriptor descriptor_;
  bool held_ = false;
};

/// The heartbeat of a run: it renews the modification time of its results file once a second (alive_s in inspect.hpp).
class FileHeartbeat {
 public:
  FileHeartbeat() = default;
  /// Throws FileError if the file cannot be opened.
  explicit FileHeartbeat(const std::filesystem::path& path);

  /// Sets the modification time to now if it is due. Whether it was due.
  bool beat();

 private:
  std::chrono::steady_clock::time_point next_{};
  Descriptor descriptor_;
};

}  // namespace rodsweep
