// Runs the tasks that the master assigns, one after the other, and reports each task.
//
// A running task calls StopRequested between time steps and within solves, and while it runs a user's code from another
// thread (solver/linear/interruption.hpp). This call also reads messages every few milliseconds and sends a heartbeat about
// every second. An exception from the task's body, such as a failed write to
// the results file, ends this rank. A failure of the task itself is an outcome (runner/measure/task_runner.hpp).
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>

#include "runner/dispatch/channel.hpp"
#include "solver/step/stopwatch.hpp"

namespace rodsweep {

/// A running task polls it between time steps and within them. True: abandon the task and discard its results.
using StopRequested = std::function<bool()>;

struct TaskResult {
  TaskOutcome outcome = TaskOutcome::pending;  ///< pending: abandoned on request
  std::string message;
};

/// Runs one task.
using TaskBody = std::function<TaskResult(std::int64_t task, const StopRequested& stop)>;

/// The heartbeat of a worker.
struct Heartbeat {
  std::chrono::duration<double> interval{1};
  std::function<std::int64_t()> saved = [] { return 0; };  ///< number of its finished tasks on disk
};

class Worker {
 public:
  /// `signal` returns the signal that this rank received, 0 for none. `while_running` is called every few milliseconds
  /// during a task, and while idle (on a single rank it runs the master).
  Worker(Channel& channel, TaskBody body, std::function<int()> signal, std::function<void()> while_running = {},
         Heartbeat heartbeat = {}, TimeSource now = std::chrono::steady_clock::now);

  /// Handles all arrived messages, then runs at most one task.
  enum class Step { worked, waited, finished };
  Step step();

  /// Calls step() until dismissed; sleeps while idle. Returns true if ranks were lost: then make no collective calls.
  bool run();

 private:
  bool receive();
  void heed_signal();
  void beat();
  void give_back();
  void run(std::int64_t task);
  bool stop_requested();

  Channel* channel_;
  TaskBody body_;
  std::function<int()> signal_;
  std::function<void()> while_running_;
  Heartbeat heartbeat_;
  TimeSource now_;
  std::deque<std::int64_t> hand_;  ///< assigned tasks

  bool stopping_ = false, dismissed_ = false, ranks_lost_ = false, told_ = false;
  TimePoint looked_{}, beat_{};
};

}  // namespace rodsweep
