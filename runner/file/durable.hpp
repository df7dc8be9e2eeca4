// Syncs files to disk in order. Only synced data survives a power cut.
//
// The kernel writes pages back at any time and in any order. Data must be synced before a state byte or a name in a
// folder marks it as valid. Throws FileError if a sync fails.
#pragma once

#include <chrono>
#include <filesystem>

#include "runner/file/descriptor.hpp"

namespace rodsweep {

/// Syncs a file's data and length, including writes of other processes on this host.
class SyncedFile {
 public:
  SyncedFile() = default;
  explicit SyncedFile(const std::filesystem::path& path);

  void sync() const;
  /// A heartbeat: sets the file's modification time to now, at most every few seconds.
  void beat();

 private:
  std::chrono::steady_clock::time_point next_beat_{};
  std::filesystem::path path_;
  Descriptor descriptor_;
};

/// Syncs the folder that contains a file.
void sync_folder_of(const std::filesystem::path& path);

}  // namespace rodsweep
