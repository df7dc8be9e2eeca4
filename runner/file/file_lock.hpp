// A lock against a second run on a results file. The kernel releases it when the owner dies.
//
// An open-file-description lock (fcntl) on a byte far behind the end of the file, where there is no data and no other
// lock. Works on NFS from version 4 on. Has no effect on file systems without locks.
#pragma once

#include <filesystem>
#include <optional>

#include "runner/file/durable.hpp"

namespace rodsweep {

class FileLock {
 public:
  FileLock() = default;
  /// Throws FileError if another run holds the lock.
  explicit FileLock(const std::filesystem::path& path);

  bool held() const { return held_; }  ///< false: the file system has no locks

  /// Whether a run on any host holds the lock; none if unknown.
  static std::optional<bool> is_held(const std::filesystem::path& path);

 private:
  Descriptor descriptor_;
  bool held_ = false;
};

}  // namespace rodsweep
