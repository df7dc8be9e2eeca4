#include "runner/python/surroundings.hpp"

#include <patchlevel.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

/// Rank 1, which is a worker, or a process that is alone.
bool prints() {
  const char* rank = std::getenv("OMPI_COMM_WORLD_RANK");
  const char* size = std::getenv("OMPI_COMM_WORLD_SIZE");
  return !rank || std::string_view(rank) == (size && std::string_view(size) == "1" ? "0" : "1");
}

/// "3.12.1" of the lines "version = 3.12.1" (venv) or "version_info = 3.12.1.final.0" (virtualenv); else empty.
std::string version_of(const fs::path& environment) {
  std::ifstream in(environment / "pyvenv.cfg");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("version", 0) == 0)
      if (const std::size_t at = line.find_first_of("0123456789"); at != std::string::npos) return line.substr(at);
  return {};
}

}  // namespace

void warn(const std::string& text) {
  if (prints()) std::fputs(("rodsweep: warning: " + text + '\n').c_str(), stderr);
}

void check_environment(const std::string& environment) {
  const std::string own = std::to_string(PY_MAJOR_VERSION) + '.' + std::to_string(PY_MINOR_VERSION);
  std::error_code error;
  if (fs::exists(fs::path(environment) / "lib" / ("python" + own) / "site-packages", error)) return;
  const std::string other = version_of(environment);
  warn("VIRTUAL_ENV is " + environment + (other.empty() ? ", no environment of Python" : ", of Python " + other) +
       ": its packages are not found by rodsweep's Python " + own + "; make one with python" + own + " -m venv");
}

}  // namespace rodsweep
