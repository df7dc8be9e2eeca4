// Input files that are parsed once per process, skeletons and curves; and how their texts are read.
#pragma once

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

namespace rodsweep {

/// What `parse(text, file)` makes of a file with this content hash. Throws Error, "FILE: cannot be read".
template <class Error, class Parse>
const auto& parsed_once(const std::filesystem::path& file, const std::string& hash, const Parse& parse) {
  using Parsed = decltype(parse(std::string(), file));
  static std::map<std::pair<std::filesystem::path, std::string>, Parsed> files;
  if (const auto known = files.find({file, hash}); known != files.end()) return known->second;
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  if (in) text << in.rdbuf();
  if (!in) throw Error(file.native() + ": cannot be read");
  return files.emplace(std::pair(file, hash), parse(text.str(), file)).first->second;
}

/// The text without a byte order mark, and with line feeds at the ends of lines, also if they were carriage returns.
inline std::string with_line_feeds(std::string text) {
  constexpr const char* byte_order_mark = "\xEF\xBB\xBF";
  if (text.compare(0, 3, byte_order_mark) == 0) text.erase(0, 3);
  const bool old_ends = text.find('\n') == std::string::npos;
  std::replace(text.begin(), text.end(), '\r', old_ends ? '\n' : ' ');
  return text;
}

/// The number that a word is, maybe with a plus sign.
template <class Number>
std::optional<Number> number_in(const std::string& word) {
  const char* begin = word.data() + (word.size() > 1 && word[0] == '+' && word[1] != '-' ? 1 : 0);
  Number value{};
  const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return {};
  return value;
}

}  // namespace rodsweep
