#include "runner/terminal/process_copy.hpp"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <system_error>

namespace rodsweep {
namespace {

constexpr std::array<int, 5> crashes{SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL};

/// 0 in the copy, which asks to end should this process end before it.
pid_t copy_process() {
  const pid_t parent = getpid();
  const pid_t copy = fork();
  if (copy < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (copy > 0) return copy;
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(128 + SIGTERM);  // which ended before it could be asked for
  return 0;
}

int wait_for(pid_t copy) {
  int status = 0;
  while (waitpid(copy, &status, 0) < 0)
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "waitpid");
  return status;
}

}  // namespace

int signal_of_copy(const std::function<void()>& work) {
  const pid_t copy = copy_process();
  if (copy > 0) {
    const int status = wait_for(copy);
    return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  }
  try {
    work();
  } catch (...) {  // it is thrown again where it matters
  }
  _exit(0);
}

int go_on_as_copy() {
  const pid_t copy = copy_process();
  if (copy == 0) return 0;
  const int status = wait_for(copy);
  if (WIFEXITED(status)) _exit(WEXITSTATUS(status));
  const int number = WTERMSIG(status);
  if (std::find(crashes.begin(), crashes.end(), number) != crashes.end()) return number;
  std::signal(number, SIG_DFL);
  std::raise(number);
  _exit(128 + number);
}

}  // namespace rodsweep
