// A file that a job names: a model, a data set. Its path is relative to the job file; what it holds is part of what the
// tasks are, as a hash, so that a sweep cannot go on with another file under the same name.
#pragma once

#include <filesystem>
#include <string>

namespace rodsweep {

struct InputFile {
  std::string key_path;        ///< the first in the job that names it
  std::filesystem::path path;  ///< from the current folder
  std::string hash;            ///< of its bytes, sixteen hexadecimal digits
};

enum class MissingFiles { refused, accepted };  ///< accepted: without a hash, for a job that is only looked at

/// The file named `text` under `key_path` of a job file. Throws JobError where it cannot be read.
InputFile input_file(const std::filesystem::path& job, const std::string& key_path, const std::string& text,
                     MissingFiles missing);

}  // namespace rodsweep
