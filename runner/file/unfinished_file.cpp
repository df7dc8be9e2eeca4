#include "runner/file/unfinished_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <stdio.h>  // renameat2
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <random>
#include <system_error>
#include <vector>

#include "runner/file/durable.hpp"
#include "runner/file/provenance.hpp"

namespace rodsweep {

namespace fs = std::filesystem;

namespace {

FileError exists_error(const fs::path& path, const char* advice = "") {
  return FileError("{} exists already and is never overwritten: {}name another file with -o FILE", path.native(),
                   advice);
}

constexpr const char* mark = ".unfinished-";

/// The creator of an unfinished file, from the end of its name, HOST-PROCESS-RANDOM.
struct Maker {
  std::string host;
  pid_t process = 0;
};

Maker maker_of(const std::string& end) {
  const std::size_t random = end.rfind('-');
  const std::size_t process = random == std::string::npos || random == 0 ? random : end.rfind('-', random - 1);
  if (process == std::string::npos || process == 0) return {};
  return {end.substr(0, process), static_cast<pid_t>(std::atol(end.c_str() + process + 1))};
}

bool lives(pid_t process) { return process > 0 && (kill(process, 0) == 0 || errno != ESRCH); }

}  // namespace

FileError creation_error(const fs::path& path, const std::string& reason) {
  return FileError("{} cannot be created: {}", path.native(), reason);
}

FileError writing_error(const fs::path& path, const std::string& reason) {
  return creation_error(
      path, reason + ". The incomplete file was removed: free some space, or name a file on another disk with -o FILE");
}

void refuse_existing(const fs::path& path, const char* advice) {
  std::error_code error;
  if (fs::exists(fs::symlink_status(path, error))) throw exists_error(path, advice);
}

fs::path file_beside(const fs::path& file, const std::string& ending) {
  return file.parent_path() / (file.stem().native() + ending + ".h5");
}

void make_folder_of(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path.has_parent_path() ? path.parent_path() : fs::path("."), error);
  if (error) throw creation_error(path, "its folder cannot be created: " + error.message());
}

FileIdentity identity_of(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0)
    throw FileError("{} cannot be found: {}", path.native(), std::system_category().message(errno));
  return {status.st_dev, status.st_ino};
}

UnfinishedFile::UnfinishedFile(const fs::path& path)
    : path_(path),
      temporary_(fmt::format("{}{}{}-{}-{:08x}", path.native(), mark, host_name(), getpid(), std::random_device()())) {}

std::string unfinished_text(const fs::path& path) {
  const std::string begin = path.filename().native() + mark;
  std::vector<std::string> left;
  bool elsewhere = false;
  std::error_code error;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().native();
    if (name.compare(0, begin.size(), begin) != 0) continue;
    const Maker maker = maker_of(name.substr(begin.size()));
    const bool here = maker.host == host_name();
    if (here && lives(maker.process)) continue;
    elsewhere = elsewhere || !here;
    left.push_back((path.parent_path() / name).native());
  }
  if (left.empty()) return "";
  std::sort(left.begin(), left.end());
  return fmt::format("{} {} left by a program that ended while it wrote {}: it can be deleted{}",
                     fmt::join(left, " and "), left.size() == 1 ? "was" : "were", path.native(),
                     elsewhere ? ", unless that program still runs on the host in its name" : "");
}

UnfinishedFile::~UnfinishedFile() {
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void UnfinishedFile::create() const {
  if (!Descriptor(open(temporary_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0600)))
    throw creation_error(path_, std::system_category().message(errno));
}

void UnfinishedFile::check_creatable() const {
  create();
  unlink(temporary_.c_str());
}

void UnfinishedFile::publish() const {
  SyncedFile(temporary_).sync();
  const bool linked = link(temporary_.c_str(), path_.c_str()) == 0;
  // On file systems without hard links, rename instead.
  if (!linked &&
      (errno == EEXIST || renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, path_.c_str(), RENAME_NOREPLACE) != 0)) {
    if (errno == EEXIST) throw exists_error(path_);
    throw creation_error(path_, std::system_category().message(errno));
  }
  sync_folder_of(path_);
}

void UnfinishedFile::replace(const FileIdentity& earlier) const {
  if (!(identity_of(path_) == earlier))
    throw FileError("{} was replaced by another program and is not overwritten", path_.native());
  SyncedFile(temporary_).sync();
  if (rename(temporary_.c_str(), path_.c_str()) != 0)
    throw creation_error(path_, std::system_category().message(errno));
  sync_folder_of(path_);
}

}  // namespace rodsweep
