// A program that runs beside this one, in a process group of its own, without a standard input. It is asked to stop
// (SIGUSR1) should this process end before it. Throws std::system_error where it cannot be started.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace rodsweep {

class ChildProcess {
 public:
  /// Words of the command line; the program is looked for as a shell does.
  explicit ChildProcess(const std::vector<std::string>& words);
  /// Waits for it.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  bool runs();
  void signal(int number) const;
  void kill_group() const;
  int status() const { return status_; }  ///< as of wait(), once it has ended

 private:
  pid_t process_ = -1;
  int status_ = -1;
  bool ended_ = false;
};

/// The exit code in a status, or 128 and the signal's number, as shells say it.
int exit_code_of(int status);
/// "exit code 2", "signal 9 (Killed)".
std::string status_text(int status);

}  // namespace rodsweep
