#include "runner/command/commands.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "runner/dispatch/stop_signal.hpp"
#include "runner/file/durable.hpp"
#include "runner/text/beside_program.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> own_arguments() {
  std::ifstream in("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> arguments;
  for (std::string word; std::getline(in, word, '\0');) arguments.push_back(word);
  return arguments;
}

volatile std::sig_atomic_t mpirun = 0;

/// While it lives, the signals that request a stop go to mpirun. They are blocked until unblock().
class ForwardedSignals {
 public:
  ForwardedSignals() {
    sigset_t all;
    sigemptyset(&all);
    struct sigaction action {};
    action.sa_handler = [](int signal) { kill(mpirun, signal); };
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    for (const int signal : stop_signals) {
      struct sigaction before {};
      sigaction(signal, nullptr, &before);
      if (signal == SIGHUP && before.sa_handler == SIG_IGN) continue;  // nohup
      sigaddset(&all, signal);
      sigaction(signal, &action, nullptr);
      forwarded_.push_back(signal);
    }
    sigprocmask(SIG_BLOCK, &all, &mask_);
  }
  void unblock() const { sigprocmask(SIG_SETMASK, &mask_, nullptr); }
  /// For the process that becomes mpirun.
  void end() const {
    for (const int signal : forwarded_) std::signal(signal, SIG_DFL);
    unblock();
  }

 private:
  std::vector<int> forwarded_;
  sigset_t mask_;
};

/// In the child process. A group of its own keeps the terminal's Ctrl-C from mpirun, which would get it twice.
[[noreturn]] void exec_mpirun(const std::vector<char*>& arguments, int output, const ForwardedSignals& forwarded) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  setpgid(0, 0);
  std::signal(SIGTTOU, SIG_IGN);  // it may write to the terminal
  dup2(output, STDOUT_FILENO);
  dup2(open("/dev/null", O_RDONLY | O_CLOEXEC), STDIN_FILENO);
  forwarded.end();
  execvp(arguments[0], arguments.data());
  Console(true).error(fmt::format("mpirun cannot be started for --workers: {}", std::strerror(errno)));
  std::_Exit(static_cast<int>(ExitCode::user_error));
}

bool is_program(const fs::path& path) { return fs::is_regular_file(path) && access(path.c_str(), X_OK) == 0; }

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

ExitCode launch(int ranks, Console& console) {
  std::vector<std::string> words;
  const std::string settings = beside_program({"../share/rodsweep/mpi-env.sh", "../cmake/mpi-env.sh"});
  if (!settings.empty()) words.push_back(settings);
  for (const std::string& word : {std::string("mpirun"), std::string("-n"), std::to_string(ranks)})
    words.push_back(word);
  for (std::string& word : own_arguments()) words.push_back(std::move(word));
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    throw std::runtime_error(fmt::format("mpirun cannot be started for --workers: {}", std::strerror(errno)));
  const Descriptor output(ends[0]);
  Descriptor input(ends[1]);
  const ForwardedSignals forwarded;
  mpirun = fork();
  if (mpirun == 0) exec_mpirun(arguments, input.number(), forwarded);
  if (mpirun < 0)
    throw std::runtime_error(fmt::format("mpirun cannot be started for --workers: {}", std::strerror(errno)));
  forwarded.unblock();
  input = Descriptor();
  std::array<char, 1 << 12> block{};
  for (ssize_t count; (count = read(output.number(), block.data(), block.size())) != 0;)
    if (count > 0) console.raw_result({block.data(), static_cast<std::size_t>(count)});
  int status = 0;
  while (waitpid(mpirun, &status, 0) < 0 && errno == EINTR) {
  }
  return static_cast<ExitCode>(WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status));
}

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
