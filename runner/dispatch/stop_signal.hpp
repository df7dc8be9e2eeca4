// Turns the signals by which people and schedulers end programs into a request to stop: SIGTERM, SIGINT, SIGUSR1, SIGUSR2
// (Grid Engine), SIGXCPU (PBS, Grid Engine), SIGHUP unless it is ignored (nohup). The handlers are installed for the
// lifetime of the object; the destructor restores the old ones. The handler only records the first signal. A second one
// has no effect, unless this process has been in a user's code since the first, for a second at least: such code may never
// return, and then the second signal ends the process. Processes that such code forks end at the first signal, as they would
// without the handler: Python's multiprocessing ends its workers with SIGTERM.
#pragma once

#include <array>
#include <csignal>
#include <string>

namespace rodsweep {

inline constexpr std::array stop_signals{SIGTERM, SIGINT, SIGUSR1, SIGUSR2, SIGXCPU, SIGHUP};

class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// The first signal received; 0 if none.
  int received() const;

 private:
  std::array<struct sigaction, stop_signals.size()> before_{};
};

/// The likely cause of the received signal, for messages: "SIGUSR1", "Ctrl-C (SIGINT)". mpirun sends SIGTERM on Ctrl-C,
/// on a SIGTERM of its own and on the death of a rank. These cannot be distinguished: "mpirun (SIGTERM), which got
/// Ctrl-C or a signal, or lost a rank".
std::string signal_cause(int signal);

}  // namespace rodsweep
