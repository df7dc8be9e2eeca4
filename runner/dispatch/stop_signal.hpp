// SIGTERM, SIGINT and SIGUSR1 as a request to stop, as soon as a task may be abandoned. Installed for the life of the
// object, then the old handlers return. The handler only notes the number, so a second signal during the stop changes
// nothing.
#pragma once

#include <array>
#include <csignal>

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

}  // namespace rodsweep
