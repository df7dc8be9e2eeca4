// Syncs files to disk in order. Only synced data survives a power cut.
//
// The kernel writes pages back at any time and in any order. Data must be synced before a state byte or a name in a
// folder marks it as valid. Throws FileError if a sync fails.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <utility>

namespace rodsweep {

/// Owns one file descriptor; empty after a move.
class Descriptor {
 public:
  Descriptor() = default;
  /// `number`: as returned by open(); negative: none.
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }

  int number() const { return number_; }
  explicit operator bool() const { return number_ >= 0; }

 private:
  int number_ = -1;
};

/// Syncs a file's data and length, including writes of other processes on this host.
class SyncedFile {
 public:
  SyncedFile() = default;
  explicit SyncedFile(const std::filesystem::path& path);

  void sync() const;
  /// Whether the path still leads to this file.
  bool is_in_place() const;

 private:
  std::filesystem::path path_;
  Descriptor descriptor_;
};

/// Syncs the folder that contains a file.
void sync_folder_of(const std::filesystem::path& path);

}  // namespace rodsweep
