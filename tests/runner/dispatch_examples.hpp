// A sweep in one process: master, workers and a network that tests can play by hand.
#pragma once

#include <vector>

#include "runner/dispatch/master.hpp"
#include "runner/dispatch/worker.hpp"
#include "tests/hand_clock.hpp"

namespace rodsweep::examples {

/// Master over `workers` workers (ranks 1 ...), silent.
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
  int signal = 0;  ///< that the master's rank received
  Master master;
};

inline std::vector<PendingTask> tasks_of_cost(const std::vector<double>& costs) {
  std::vector<PendingTask> tasks;
  for (const double cost : costs) tasks.push_back({static_cast<std::int64_t>(tasks.size()), cost});
  return tasks;
}

/// The tasks that have been assigned to this rank since the last call; other messages are counted.
struct Inbox {
  explicit Inbox(Channel& of) : channel(&of) {}

  std::vector<std::int64_t> assigned() {
    std::vector<std::int64_t> tasks;
    while (const auto envelope = channel->probe()) {
      if (envelope->tag == Tag::assign)
        for (const std::int64_t task : channel->receive<Assign>(*envelope).tasks()) tasks.push_back(task);
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
