// Runs the tasks that the master assigns, one assignment after the other, and reports each task.
//
// While they run it asks, between time steps and within them, whether to stop; every few milliseconds that question
// also looks at the messages, and every second or so it tells the master that this rank can still look up. An exception
// from the task's body is the end of this rank (say, a results file that cannot be written): what is wrong with a task
// is an outcome, and the body's affair (runner/experiment/task_body.hpp).
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "runner/dispatch/channel.hpp"
#include "runner/dispatch/stop_requested.hpp"

namespace rodsweep {

struct TaskResult {
  TaskOutcome outcome = TaskOutcome::pending;  ///< pending: abandoned on request
  std::string message;
  double share = 0;  ///< of its steps that were done, if abandoned
};

/// Runs one task.
using TaskBody = std::function<TaskResult(std::int64_t task, const StopRequested& stop)>;

/// Runs the tasks of an assignment. One result for each.
using BatchBody =
    std::function<std::vector<TaskResult>(const std::vector<std::int64_t>& tasks, const StopRequested& stop)>;

BatchBody one_by_one(TaskBody body);

class Worker {
 public:
  /// `signal` tells the signal that this rank received, 0 for none. `while_running` is called now and then between two
  /// time steps, and while there is nothing to do (a lone rank keeps its master alive there).
  Worker(Channel& channel, BatchBody body, std::function<int()> signal, std::function<void()> while_running = {});
  Worker(Channel& channel, TaskBody body, std::function<int()> signal, std::function<void()> while_running = {});

  /// Tells the master so often that this rank looks up, and of how many of its tasks the results are on disk: by
  /// default every second, and nothing of the latter.
  void set_beat(std::chrono::duration<double> pause, std::function<std::int64_t()> kept) {
    beat_pause_ = pause;
    kept_ = std::move(kept);
  }

  /// Deals with all messages that have arrived, then runs at most one assignment.
  enum class Step { worked, waited, finished };
  Step step();

  /// Steps until dismissed, asleep while there is nothing to do. True: ranks are lost, and what takes all of them must
  /// not be tried.
  bool run();

 private:
  bool receive();
  void heed_signal();
  void beat();
  void give_back();
  void run(const std::vector<std::int64_t>& tasks);
  bool stop_requested();

  Channel* channel_;
  BatchBody body_;
  std::function<int()> signal_;
  std::function<void()> while_running_;
  std::deque<std::vector<std::int64_t>> hand_;  ///< assignments

  bool dropping_ = false, stopping_ = false, dismissed_ = false, apart_ = false, told_ = false;
  std::chrono::steady_clock::time_point looked_{}, beat_{};
  std::chrono::duration<double> beat_pause_{1};
  std::function<std::int64_t()> kept_;
};

}  // namespace rodsweep
