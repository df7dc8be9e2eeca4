// A file in the making: it has a temporary name beside its own, and gets its own name when it is whole, in one step
// that never replaces another file and that a power cut either undoes or leaves whole. Whatever bears the temporary
// name when this dies is removed: two programs cannot make the same file, and one that is killed meanwhile leaves its
// name free. Throws FileError.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "runner/file/file_error.hpp"

namespace rodsweep {

FileError creation_error(const std::filesystem::path& path, const std::string& reason);
/// The same in the middle, most often for want of space.
FileError writing_error(const std::filesystem::path& path, const std::string& reason);

/// Which file a path leads to, whatever its name.
struct FileIdentity {
  std::uintmax_t device = 0, number = 0;
  bool operator==(const FileIdentity& other) const { return device == other.device && number == other.number; }
};
FileIdentity identity_of(const std::filesystem::path& path);

class UnfinishedFile {
 public:
  /// `path` is the name that it will get. Creates nothing.
  explicit UnfinishedFile(const std::filesystem::path& path);
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;
  ~UnfinishedFile();

  const std::filesystem::path& path() const { return temporary_; }

  /// Asks the system whether it can be made: its reason reads better than HDF5's error stack.
  void check_creatable() const;

  /// Gives the file its name unless another file took it meanwhile.
  void publish() const;
  /// Gives it its name in place of an earlier state of itself, which must still be there.
  void replace(const FileIdentity& earlier) const;

 private:
  std::filesystem::path path_, temporary_;
};

/// What a program left that was ended while it made `path`, as a sentence for the user: empty where there is nothing.
std::string unfinished_text(const std::filesystem::path& path);

/// Refuses a path that exists, be it as a dangling link.
void refuse_existing(const std::filesystem::path& path);

/// results/demo.h5, "-task-12": results/demo-task-12.h5
std::filesystem::path file_beside(const std::filesystem::path& file, const std::string& ending);

/// Makes the folders on the way to `path`.
void make_folder_of(const std::filesystem::path& path);

}  // namespace rodsweep
