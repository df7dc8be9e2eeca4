// An input file of a job. Its path is relative to the job file. The hash of its content is part of the tasks' identity,
// so a sweep cannot be resumed with a changed file.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace rodsweep {

/// What a file must be, as the row of its key says. Several keys may have the same file.
enum class FileKind { any, model, data_set, skeleton, curves, results, plugin, python_guess, python_preconditioner };

/// A key with a file.
struct FileUse {
  std::string key_path;
  FileKind kind;
};
using FileUses = std::vector<FileUse>;  ///< the first key of each kind, in job order

struct InputFile {
  std::filesystem::path path;  ///< from the current folder
  std::string hash;            ///< of its content, sixteen hexadecimal digits; empty if it is missing
  FileUses uses;

  bool is_used_as(FileKind kind) const;
};

/// By path as written in the job.
using InputFiles = std::map<std::string, InputFile>;

/// A job file, and its input files.
struct JobFiles {
  std::filesystem::path path;  ///< as given by the user; its folder is the base of relative paths in the job
  InputFiles files;
};

/// Serialisation of paths and hashes for other ranks, so that they need not read whole data sets to hash them.
std::string to_bytes(const InputFiles& files);
InputFiles from_bytes(const std::string& bytes);

enum class MissingFiles { refused, accepted };  ///< accepted: without a hash, for a job that is not run

/// An input file that does not exist.
struct MissingFile {
  std::string key_path, written;  ///< the path as written in the job
  std::filesystem::path path;     ///< from the current folder
};

/// The error text for a missing file, with a suggestion: a job in the folder that makes the file, or the nearest file
/// name.
std::string missing_file_text(const std::filesystem::path& job, const MissingFile& file);

/// The file `text` at `key_path` of a job file, without uses. Throws JobError if it cannot be read.
InputFile input_file(const std::filesystem::path& job, const std::string& key_path, const std::string& text,
                     MissingFiles missing);

}  // namespace rodsweep
