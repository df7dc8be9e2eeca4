// An error in a job file. what() is the complete message for the user: one line per mistake, each with the file first.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

#include "runner/text/shortened.hpp"

namespace rodsweep {

class JobError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// "FILE: KEY.PATH: TEXT"; without a key path "FILE: TEXT".
inline JobError job_error(const std::filesystem::path& file, const std::string& key_path, const std::string& text) {
  constexpr std::size_t longest_path = 200;
  return JobError(file.string() + ": " + (key_path.empty() ? "" : shortened(key_path, longest_path) + ": ") + text);
}

}  // namespace rodsweep
