#include "runner/command/scripts.hpp"

#include <fmt/format.h>

#include "runner/terminal/text.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

std::string path_from_here(const std::string& name) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  for (const char* folder : {"../share/rodsweep/analysis", "../analysis"}) {
    const fs::path script = (program.parent_path() / folder / name).lexically_normal();
    if (!fs::exists(script, error)) continue;
    const std::string here = fs::proximate(script, error).native();
    return here.empty() || here.size() > script.native().size() ? script.native() : here;
  }
  return "analysis/" + name;
}

}  // namespace

std::string script_line(const std::string& script, const fs::path& file) {
  return fmt::format("/usr/bin/python3 {} {}", shell_quoted(path_from_here(script)), shell_quoted(file.native()));
}

}  // namespace rodsweep
