#include "runner/dispatch/stop_signal.hpp"

#include <fmt/format.h>

#include <time.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

#include "solver/plugin/user_call.hpp"

namespace rodsweep {

namespace {

volatile std::sig_atomic_t first_signal = 0;
volatile std::sig_atomic_t from_parent = 0;  ///< whether the parent process sent it
timespec received_at{};
pid_t own_process = 0;

/// Ends this process by the signal, once its handler has returned.
void end_by(int signal) {
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void note(int signal, siginfo_t* told, void*) {
  if (getpid() != own_process) return end_by(signal);
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (first_signal != 0) {
    if (user_code() && now.tv_sec - received_at.tv_sec > 1) end_by(signal);
    return;
  }
  received_at = now;
  from_parent = told->si_code <= 0 && told->si_pid == getppid() ? 1 : 0;
  first_signal = signal;
}

bool is_under_mpirun() { return std::getenv("OMPI_COMM_WORLD_RANK") != nullptr; }

}  // namespace

StopSignal::StopSignal() {
  first_signal = 0;
  own_process = getpid();
  struct sigaction action {};
  action.sa_sigaction = note;
  action.sa_flags = SA_SIGINFO | SA_RESTART;  // a signal must not fail a write to the results file
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < stop_signals.size(); ++i) {
    sigaction(stop_signals[i], nullptr, &before_[i]);
    const bool ignored = stop_signals[i] == SIGHUP && before_[i].sa_handler == SIG_IGN;
    if (!ignored) sigaction(stop_signals[i], &action, nullptr);
  }
}

StopSignal::~StopSignal() {
  for (std::size_t i = 0; i < stop_signals.size(); ++i) sigaction(stop_signals[i], &before_[i], nullptr);
}

int StopSignal::received() const { return first_signal; }

std::string signal_cause(int signal) {
  if (signal == SIGINT) return "Ctrl-C (SIGINT)";
  if (signal == SIGTERM && from_parent != 0 && is_under_mpirun())
    return "mpirun (SIGTERM), after Ctrl-C, a signal or the loss of a rank";
  return fmt::format("SIG{}", sigabbrev_np(signal));
}

}  // namespace rodsweep
