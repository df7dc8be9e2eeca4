#include "runner/command/process_end.hpp"

#include <dlfcn.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>

#include "solver/plugin/user_call.hpp"

namespace rodsweep {
namespace {

const pid_t own_process = getpid();
std::atomic<ExitCode> code_of_exit{ExitCode::user_error};
std::atomic<const char*> advice_of_exit{""};

[[noreturn]] void end_now(int status) {
  for (;;) syscall(SYS_exit_group, status);
}

void refuse_foreign(int status) {
  if (process_is_ending() || getpid() != own_process) return;
  // Tasks run in the first thread. Open MPI's own thread ends the process when mpirun has died, and reports it.
  const char* const code = gettid() == own_process ? user_code() : nullptr;
  if (!code && status != 0) return;
  std::fprintf(stderr,
               "%srodsweep: error: %s ended this process (exit status %d); it must return or raise an error%s\n",
               isatty(STDERR_FILENO) ? "\n" : "", code ? code : "a library", status, advice_of_exit.load());
  end_now(static_cast<int>(code_of_exit.load()));
}

[[noreturn]] void end_by(const char* function, int status) {
  refuse_foreign(status);
  reinterpret_cast<void (*)(int)>(dlsym(RTLD_NEXT, function))(status);
  end_now(status);
}

}  // namespace

void expect_no_exit(ExitCode code, const char* advice) noexcept {
  advice_of_exit = advice;
  code_of_exit = code;
}

}  // namespace rodsweep

extern "C" {

void exit(int status) noexcept { rodsweep::end_by("exit", status); }
void quick_exit(int status) noexcept { rodsweep::end_by("quick_exit", status); }
void _exit(int status) { rodsweep::end_by("_exit", status); }
void _Exit(int status) noexcept { rodsweep::end_by("_Exit", status); }
}
