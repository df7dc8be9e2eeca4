#include "runner/command/external_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

bool is_program(const fs::path& path) { return fs::is_regular_file(path) && access(path.c_str(), X_OK) == 0; }

}  // namespace

fs::path find_command(const std::string& name, const fs::path& program, const std::string& path) {
  const std::string file = "rodsweep-" + name;
  std::string script = name + ".py";
  std::replace(script.begin(), script.end(), '-', '_');
  std::vector<fs::path> places{program.parent_path() / file, program.parent_path().parent_path() / "analysis" / script};
  std::istringstream folders(path);
  for (std::string folder; std::getline(folders, folder, ':');) places.push_back(fs::path(folder) / file);
  const auto found = std::find_if(places.begin(), places.end(), is_program);
  return found == places.end() ? fs::path() : *found;
}

ExitCode execute(const ExternalCommand& command, Console& console) {
  std::error_code error;
  const char* path = std::getenv("PATH");
  const fs::path program =
      find_command(command.name, fs::read_symlink("/proc/self/exe", error), path == nullptr ? "" : path);
  if (program.empty()) {
    console.raw_error(command.unknown);
    return ExitCode::user_error;
  }
  std::vector<const char*> arguments{program.c_str()};
  for (const std::string& word : command.words) arguments.push_back(word.c_str());
  arguments.push_back(nullptr);
  execv(program.c_str(), const_cast<char* const*>(arguments.data()));
  console.error(fmt::format("{} cannot be started: {}{}", program.native(), std::strerror(errno),
                            errno == ENOENT ? "; it needs Python 3: apt-get install python3-h5py python3-scipy" : ""));
  return ExitCode::user_error;
}

}  // namespace rodsweep
