#include "runner/file/unfinished_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdio.h>  // renameat2
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <random>
#include <system_error>

#include "runner/file/durable.hpp"
#include "runner/file/provenance.hpp"

namespace rodsweep {

namespace fs = std::filesystem;

namespace {

FileError exists_error(const fs::path& path) {
  return FileError(
      fmt::format("{} exists already and is never overwritten: name another file with -o FILE", path.native()));
}

}  // namespace

FileError creation_error(const fs::path& path, const std::string& reason) {
  return FileError(fmt::format("{} cannot be created: {}", path.native(), reason));
}

void refuse_existing(const fs::path& path) {
  std::error_code error;
  if (fs::exists(fs::symlink_status(path, error))) throw exists_error(path);
}

fs::path file_beside(const fs::path& file, const std::string& ending) {
  return file.parent_path() / (file.stem().native() + ending + ".h5");
}

void make_folder_of(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path.has_parent_path() ? path.parent_path() : fs::path("."), error);
  if (error) throw creation_error(path, "its folder cannot be made: " + error.message());
}

FileIdentity identity_of(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0)
    throw FileError(fmt::format("{} cannot be found again: {}", path.native(), std::system_category().message(errno)));
  return {status.st_dev, status.st_ino};
}

UnfinishedFile::UnfinishedFile(const fs::path& path)
    : path_(path),
      temporary_(
          fmt::format("{}.unfinished-{}-{}-{:08x}", path.native(), host_name(), getpid(), std::random_device()())) {}

UnfinishedFile::~UnfinishedFile() {
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void UnfinishedFile::check_creatable() const {
  if (!Descriptor(open(temporary_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0600)))
    throw creation_error(path_, std::system_category().message(errno));
  unlink(temporary_.c_str());
}

void UnfinishedFile::publish() const {
  SyncedFile(temporary_).sync();
  const bool linked = link(temporary_.c_str(), path_.c_str()) == 0;
  // Renamed on a file system without hard links.
  if (!linked &&
      (errno == EEXIST || renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, path_.c_str(), RENAME_NOREPLACE) != 0)) {
    if (errno == EEXIST) throw exists_error(path_);
    throw creation_error(path_, std::system_category().message(errno));
  }
  sync_folder_of(path_);
}

void UnfinishedFile::replace(const FileIdentity& earlier) const {
  if (!(identity_of(path_) == earlier))
    throw FileError(fmt::format("{} was replaced by another program meanwhile, and is left as it is", path_.native()));
  SyncedFile(temporary_).sync();
  if (rename(temporary_.c_str(), path_.c_str()) != 0)
    throw creation_error(path_, std::system_category().message(errno));
  sync_folder_of(path_);
}

}  // namespace rodsweep
