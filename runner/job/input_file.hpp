// A file that a job names: a model, a data set. Its path is relative to the job file; what it holds is part of what the
// tasks are, as a hash, so that a sweep cannot go on with another file under the same name.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace rodsweep {

struct InputFile {
  std::string key_path;        ///< the first in the job that names it
  std::filesystem::path path;  ///< from the current folder
  std::string hash;            ///< of its bytes, sixteen hexadecimal digits
};

/// By their path as the job has it.
using InputFiles = std::map<std::string, InputFile>;

/// For other ranks, which need not read whole data sets to know what they hold.
std::string to_bytes(const InputFiles& files);
InputFiles from_bytes(const std::string& bytes);

enum class MissingFiles { refused, accepted };  ///< accepted: without a hash, for a job that is only looked at

/// The file named `text` under `key_path` of a job file. Throws JobError where it cannot be read.
InputFile input_file(const std::filesystem::path& job, const std::string& key_path, const std::string& text,
                     MissingFiles missing);

/// A file that a job names and that is not there.
struct MissingFile {
  std::string key_path, written;  ///< the path as it stands in the job
  std::filesystem::path path;     ///< from the current folder
};

struct Job;

/// Those of a job that was read with MissingFiles::accepted, and the data sets of a training.
std::vector<MissingFile> missing_files(const Job& job);

/// Why that is no sound job, with what may have been meant: a job beside that makes the file, or the nearest name in
/// its folder.
std::string missing_file_text(const std::filesystem::path& job, const MissingFile& file);

}  // namespace rodsweep
