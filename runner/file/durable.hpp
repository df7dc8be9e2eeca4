// Getting what was written onto the disk, in order: what outlives a power cut is what was synced before it.
//
// The kernel writes pages back when and in which order it likes. Where one part of a file says that another is there
// (a state byte, a name in a folder), the other has to be synced first. Throws FileError where the disk says no.
#pragma once

#include <chrono>
#include <filesystem>

#include "runner/file/descriptor.hpp"

namespace rodsweep {

/// A file's data and length, whoever on this host wrote them.
class SyncedFile {
 public:
  SyncedFile() = default;
  explicit SyncedFile(const std::filesystem::path& path);

  void sync() const;
  /// Every few seconds, says "now" in the file's modification time: a sign of life for those who watch the file.
  void beat();

 private:
  std::chrono::steady_clock::time_point next_beat_{};
  std::filesystem::path path_;
  Descriptor descriptor_;
};

/// The names in the folder that a file is in.
void sync_folder_of(const std::filesystem::path& path);

}  // namespace rodsweep
