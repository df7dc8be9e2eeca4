// A file under construction. It has a temporary name in the same folder, and is renamed atomically when complete. This
// never overwrites another file and survives a power cut. The destructor removes the temporary file. So two programs
// can't create the same file, and a killed program does not block its name. Throws FileError.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "runner/file/file_error.hpp"

namespace rodsweep {

FileError creation_error(const std::filesystem::path& path, const std::string& reason);
/// The same for an error while writing, usually a full disk.
FileError writing_error(const std::filesystem::path& path, const std::string& reason);

/// The identity of a file, independent of its path.
struct FileIdentity {
  std::uintmax_t device = 0, number = 0;
  bool operator==(const FileIdentity& other) const { return device == other.device && number == other.number; }
};
FileIdentity identity_of(const std::filesystem::path& path);

class UnfinishedFile {
 public:
  /// `path`: the final name. Does not create the file.
  explicit UnfinishedFile(const std::filesystem::path& path);
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;
  ~UnfinishedFile();

  const std::filesystem::path& path() const { return temporary_; }

  /// Creates an empty file; throws if that is impossible.
  void create() const;
  /// Tries to create the file, because the system's error message is clearer than HDF5's error stack.
  void check_creatable() const;

  /// Gives the file its final name; throws if another file has it.
  void publish() const;
  /// Replaces the earlier version of the file; throws if another file has its name.
  void replace(const FileIdentity& earlier) const;

 private:
  std::filesystem::path path_, temporary_;
};

/// A message about temporary files left by killed programs that were creating `path`; empty if there are none.
std::string unfinished_text(const std::filesystem::path& path);

/// Throws FileError if the path exists, also as a dangling link. `advice`: before that to name another file.
void refuse_existing(const std::filesystem::path& path, const char* advice = "");
inline constexpr const char* resume_advice = "continue it with --resume, or ";

/// results/demo.h5, "-task-12": results/demo-task-12.h5
std::filesystem::path file_beside(const std::filesystem::path& file, const std::string& ending);

/// Creates the parent folders of `path`.
void make_folder_of(const std::filesystem::path& path);

}  // namespace rodsweep
