// Keeps a second run away from a results file: a lock that the kernel takes back when its owner dies, however it dies.
//
// An open-file-description lock (fcntl) on a byte far behind the end of the file, where no data and nobody else's locks
// are; NFS from version 4 on knows them too. On file systems without locks there is none.
#pragma once

#include <filesystem>
#include <optional>

#include "runner/file/descriptor.hpp"

namespace rodsweep {

class FileLock {
 public:
  FileLock() = default;
  /// Throws FileError where another run has it.
  explicit FileLock(const std::filesystem::path& path);

  bool held() const { return held_; }  ///< false: the file system has no locks

  /// Whether a run on this or another host has it; nothing where that cannot be known.
  static std::optional<bool> is_held(const std::filesystem::path& path);

 private:
  Descriptor descriptor_;
  bool held_ = false;
};

}  // namespace rodsweep
