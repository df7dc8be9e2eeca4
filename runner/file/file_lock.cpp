#include "runner/file/file_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <cerrno>
#include <system_error>

#include "runner/file/file_error.hpp"

namespace rodsweep {
namespace {

struct flock far_byte() {
  struct flock byte {};
  byte.l_type = F_WRLCK;
  byte.l_whence = SEEK_SET;
  byte.l_start = off_t{1} << 62;
  byte.l_len = 1;
  return byte;
}

}  // namespace

std::optional<bool> FileLock::is_held(const std::filesystem::path& path) {
  const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct flock byte = far_byte();
  if (!file || fcntl(file.number(), F_OFD_GETLK, &byte) != 0) return std::nullopt;
  return byte.l_type != F_UNLCK;
}

FileLock::FileLock(const std::filesystem::path& path) : descriptor_(open(path.c_str(), O_RDWR | O_CLOEXEC)) {
  if (!descriptor_) return;  // the next open of the file reports the error
  struct flock byte = far_byte();
  held_ = fcntl(descriptor_.number(), F_OFD_SETLK, &byte) == 0;
  if (!held_ && (errno == EAGAIN || errno == EACCES))
    throw FileError(
        "{} is being written by another run: wait until it ends, or stop it (`rodsweep info {}` shows its host)",
        path.native(), path.native());
  if (flock(descriptor_.number(), LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    throw FileError("{} is open for writing in another program: close it there", path.native());
}

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
