// A guess or a preconditioner of the user's in a job: a shared library (solver/plugin/plugin.h) or a file of Python
// (runner/python/python_plugin.cpp).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rodsweep {

struct PluginFile {
  std::filesystem::path library;
  std::string options;
};

struct PythonFile {
  std::filesystem::path file;
  std::string options;
  std::vector<std::filesystem::path> inputs{};  ///< other files that it reads
};

}  // namespace rodsweep
