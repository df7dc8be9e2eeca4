// The heartbeat of a run: it renews the modification time of its results file once a second (alive_s in inspect.hpp).
#pragma once

#include <chrono>
#include <filesystem>

#include "runner/file/durable.hpp"

namespace rodsweep {

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
