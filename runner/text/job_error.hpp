// An error in a job file. what() is the complete message for the user: one line per mistake, each with the file first.
// Key paths in messages, columns and random streams: "scene.segments", "guesses[2].oracle.error".
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "runner/text/formatted_error.hpp"
#include "runner/text/words.hpp"

namespace rodsweep {

struct JobError : FormattedError<> {
  using FormattedError::FormattedError;
};

/// "FILE: KEY.PATH: TEXT"; without a key path "FILE: TEXT".
inline JobError job_error(const std::filesystem::path& file, const std::string& key_path, const std::string& text) {
  constexpr std::size_t longest_path = 200;
  return JobError(file.string() + ": " + (key_path.empty() ? "" : shortened(key_path, longest_path) + ": ") + text);
}

/// With a text of a format and its values.
template <class First, class... More>
JobError job_error(const std::filesystem::path& file, const std::string& key_path,
                   fmt::format_string<First, More...> text, First&& first, More&&... more) {
  return job_error(file, key_path, fmt::format(text, std::forward<First>(first), std::forward<More>(more)...));
}

inline std::string member(const std::string& path, const std::string& name) {
  return path.empty() ? name : path + "." + name;
}

inline std::string element(const std::string& path, std::size_t index) { return fmt::format("{}[{}]", path, index); }

}  // namespace rodsweep
