// A sweep in one process: the master, and a network in memory through which tests act as workers.
#pragma once

#include <vector>

#include "runner/dispatch/master.hpp"
#include "runner/dispatch/worker.hpp"
#include "tests/hand_clock.hpp"

namespace rodsweep::examples {

/// A master of `workers` workers (ranks 1 ...) without console output.
struct Sweep {
  Sweep(int workers, std::vector<PendingTask> tasks, const Timeouts& timeouts = {}, Callbacks callbacks = {})
      : network(workers + 1),
        console(false),
        progress(console, {static_cast<std::int64_t>(tasks.size()), 0, 0, 1, workers}, test::HandClock::now()),
        master(
            network[0], std::move(tasks), progress, [this] { return signal; }, timeouts, std::move(callbacks),
            test::HandClock::now) {}

  MemoryNetwork network;
  Console console;
  Progress progress;
  int signal = 0;  ///< received by the master's rank
  Master master;
};

inline std::vector<PendingTask> tasks_of_cost(const std::vector<double>& costs) {
  std::vector<PendingTask> tasks;
  for (const double cost : costs) tasks.push_back({static_cast<std::int64_t>(tasks.size()), cost});
  return tasks;
}

/// Reads the messages of a rank: assigned() returns the tasks since the last call; other messages are counted.
struct Inbox {
  explicit Inbox(Channel& of) : channel(&of) {}

  std::vector<std::int64_t> assigned() {
    std::vector<std::int64_t> tasks;
    while (const auto envelope = channel->probe()) {
      if (envelope->tag == Tag::assign) tasks.push_back(channel->receive<Assign>(*envelope).task);
      if (envelope->tag == Tag::stop) channel->receive<Stop>(*envelope), ++stops;
      if (envelope->tag == Tag::finish) ranks_lost = channel->receive<Finish>(*envelope).ranks_lost, ++finishes;
    }
    return tasks;
  }

  void report(std::int64_t task, TaskOutcome outcome = TaskOutcome::ok, std::string_view message = "") {
    channel->send(0, Report(task, outcome, 1, message));
  }

  Channel* channel;
  int stops = 0, finishes = 0;
  bool ranks_lost = false;
};

}  // namespace rodsweep::examples
