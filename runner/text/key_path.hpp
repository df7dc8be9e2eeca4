// Key paths in messages, columns and random streams: "scene.segments", "guesses[2].oracle.error".
#pragma once

#include <fmt/format.h>

#include <string>

namespace rodsweep {

inline std::string member(const std::string& path, const std::string& name) {
  return path.empty() ? name : path + "." + name;
}

inline std::string element(const std::string& path, std::size_t index) { return fmt::format("{}[{}]", path, index); }

}  // namespace rodsweep
