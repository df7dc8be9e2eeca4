#include "runner/terminal/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <system_error>

namespace rodsweep {
namespace {

[[noreturn]] void become(char* const* words, pid_t parent, int failure) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGUSR1);
  if (getppid() != parent) _exit(128 + SIGUSR1);  // which ended before it could be asked for
  if (const int nothing = open("/dev/null", O_RDONLY); nothing >= 0) dup2(nothing, STDIN_FILENO);
  for (const int number : {SIGTERM, SIGINT, SIGUSR1, SIGPIPE}) std::signal(number, SIG_DFL);
  execvp(words[0], words);
  const int why = errno;
  static_cast<void>(!write(failure, &why, sizeof why));
  _exit(127);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (const std::string& word : words) pointers.push_back(const_cast<char*>(word.c_str()));
  pointers.push_back(nullptr);
  const pid_t parent = getpid();
  int failure[2];  // closes without a word when the program runs
  if (pipe2(failure, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  process_ = fork();
  if (process_ == 0) become(pointers.data(), parent, failure[1]);
  const int not_forked = errno;
  close(failure[1]);
  int why = 0;
  const bool failed = process_ > 0 && read(failure[0], &why, sizeof why) == sizeof why;
  close(failure[0]);
  if (process_ < 0) throw std::system_error(not_forked, std::generic_category(), "fork");
  if (failed) {
    waitpid(process_, &status_, 0);
    throw std::system_error(why, std::generic_category(), words.front() + " cannot be started");
  }
  setpgid(process_, process_);  // whichever of the two is first
}

ChildProcess::~ChildProcess() {
  if (!ended_) waitpid(process_, &status_, 0);
}

bool ChildProcess::runs() {
  if (ended_) return false;
  const pid_t ended = waitpid(process_, &status_, WNOHANG);
  ended_ = ended == process_ || (ended < 0 && errno != EINTR);
  return !ended_;
}

void ChildProcess::signal(int number) const {
  if (!ended_) kill(process_, number);
}

void ChildProcess::kill_group() const {
  if (!ended_) kill(-process_, SIGKILL);
}

int exit_code_of(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

std::string status_text(int status) {
  if (WIFEXITED(status)) return fmt::format("exit code {}", WEXITSTATUS(status));
  return fmt::format("signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
}

}  // namespace rodsweep
