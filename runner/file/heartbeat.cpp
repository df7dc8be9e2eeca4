#include "runner/file/heartbeat.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <system_error>

#include "runner/file/file_error.hpp"

namespace rodsweep {

FileHeartbeat::FileHeartbeat(const std::filesystem::path& path)
    : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (!descriptor_) throw FileError(path.native() + ": " + std::system_category().message(errno));
}

bool FileHeartbeat::beat() {
  constexpr std::chrono::seconds pause{1};
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return false;
  next_ = now + pause;
  futimens(descriptor_.number(), nullptr);
  return true;
}

}  // namespace rodsweep
