// Input files that are parsed once per process: skeletons and curves.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
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

}  // namespace rodsweep
