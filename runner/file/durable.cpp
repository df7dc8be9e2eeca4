#include "runner/file/durable.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <system_error>

#include "runner/file/file_error.hpp"

namespace rodsweep {
namespace {

FileError sync_error(const std::filesystem::path& path, int code) {
  return FileError(
      "{} cannot be synced to disk: {}: fix the disk, then continue with --resume; finished tasks are kept",
      path.native(), std::system_category().message(code));
}

/// Error codes of file systems without sync. They are ignored; writes there may not survive a power cut.
bool cannot(int code) { return code == EINVAL || code == ENOTSUP || code == EROFS; }

}  // namespace

SyncedFile::SyncedFile(const std::filesystem::path& path)
    : path_(path), descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (!descriptor_) throw sync_error(path, errno);
}

void SyncedFile::sync() const {
  if (fdatasync(descriptor_.number()) != 0 && !cannot(errno)) throw sync_error(path_, errno);
}

bool SyncedFile::is_in_place() const {
  struct stat mine {
  }, there{};
  return fstat(descriptor_.number(), &mine) == 0 && stat(path_.c_str(), &there) == 0 && mine.st_dev == there.st_dev &&
         mine.st_ino == there.st_ino;
}

void sync_folder_of(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  const Descriptor descriptor(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!descriptor) return;  // the folder is writable but not readable
  if (fsync(descriptor.number()) != 0 && !cannot(errno)) throw sync_error(folder, errno);
}

}  // namespace rodsweep
