#include "runner/file/file_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "runner/file/file_error.hpp"

namespace rodsweep {

FileLock::FileLock(const std::filesystem::path& path) : descriptor_(open(path.c_str(), O_RDWR | O_CLOEXEC)) {
  if (descriptor_ < 0) return;  // whoever opens it next says why
  struct flock byte {};
  byte.l_type = F_WRLCK;
  byte.l_whence = SEEK_SET;
  byte.l_start = off_t{1} << 62;
  byte.l_len = 1;
  if (fcntl(descriptor_, F_OFD_SETLK, &byte) == 0 || (errno != EAGAIN && errno != EACCES)) return;
  ::close(std::exchange(descriptor_, -1));
  throw FileError(fmt::format(
      "{} is being written by another run: wait until it ends, or stop it (`rodsweep info {}` says where it "
      "was started)",
      path.native(), path.native()));
}

FileLock::FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

FileLock& FileLock::operator=(FileLock&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

FileLock::~FileLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace rodsweep
