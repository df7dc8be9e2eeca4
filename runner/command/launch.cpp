#include "runner/command/launch.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "runner/command/next_line.hpp"
#include "runner/text/beside_program.hpp"

namespace rodsweep {
namespace {

std::vector<std::string> own_arguments() {
  std::ifstream in("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> arguments;
  for (std::string word; std::getline(in, word, '\0');) arguments.push_back(word);
  return arguments;
}

}  // namespace

bool is_launched() {
  constexpr const char* marks[] = {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"};
  return std::any_of(std::begin(marks), std::end(marks), [](const char* mark) { return std::getenv(mark) != nullptr; });
}

std::string separate_processes_text(int ranks) {
  for (const char* variable : {"SLURM_STEP_NUM_TASKS", "PMI_SIZE"}) {
    const char* const value = std::getenv(variable);
    const int started = value == nullptr ? 0 : std::atoi(value);
    if (ranks == 1 && started > 1)
      return fmt::format(
          "{} processes were started, but they do not know of each other ({} is {}, this MPI world has one rank): use "
          "srun --mpi=pmix, or mpirun",
          started, variable, value);
  }
  return "";
}

void launch(int ranks) {
  std::vector<std::string> words;
  const std::string settings = beside_program({"../share/rodsweep/mpi-env.sh", "../cmake/mpi-env.sh"});
  if (!settings.empty()) words.push_back(settings);
  for (const std::string& word : {std::string("mpirun"), std::string("-n"), std::to_string(ranks)})
    words.push_back(word);
  for (std::string& word : own_arguments()) words.push_back(std::move(word));
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execvp(arguments[0], arguments.data());
  throw std::runtime_error(fmt::format("mpirun cannot be started for --workers: {}", std::strerror(errno)));
}

}  // namespace rodsweep
