// SIGTERM, SIGINT and SIGUSR1 as a request to stop, as soon as a task may be abandoned. Installed for the life of the
// object, then the old handlers return. The handler only notes the number, so a second signal during the stop changes
// nothing.
#pragma once

#include <array>
#include <csignal>
#include <string>

namespace rodsweep {

class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// The first signal received; 0 while there was none.
  int received() const;

 private:
  static constexpr std::array<int, 3> signals_{SIGTERM, SIGINT, SIGUSR1};
  std::array<struct sigaction, 3> before_{};
};

/// "SIGTERM", for messages.
const char* signal_name(int signal);

/// What this process knows of the signal that it received: "SIGUSR1", "Ctrl-C (SIGINT)". mpirun makes SIGTERM of
/// Ctrl-C, of a SIGTERM of its own and of the death of another rank; which it was cannot be told: "mpirun (SIGTERM),
/// which got Ctrl-C or a signal, or lost a rank".
std::string signal_cause(int signal);

}  // namespace rodsweep
