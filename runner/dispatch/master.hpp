// Hands out the tasks of a sweep, longest first (by cost, ties by number), one to each idle worker; of tasks that are
// evaluated together in batches as many as a batch holds.
//
// A worker gets a second task into its hand, to spare it the wait for the next, only while the tasks not yet handed out
// keep all workers busy for at least twice as long as both of its tasks take (by cost). So the pool never runs dry
// before it starts the second one, and at the end of a sweep no task waits in a busy worker's hand while another worker
// idles.
//
// Tasks whose workers ended while they ran, and could not say why, come after all others; where that has happened
// twice, one at a time, with nothing beside it: should a task be what ends workers, it has only itself to take along.
//
// On a signal, here or on a worker, nothing more is handed out and running tasks are abandoned.
// Every Assign is answered by one Report; the workers are dismissed (Finish) when the last one is in.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "runner/dispatch/channel.hpp"
#include "runner/terminal/progress.hpp"

namespace rodsweep {

struct PendingTask {
  std::int64_t index = 0;
  double cost = 0;
  std::int64_t batch = -1;  ///< tasks of equal cost and number here may be evaluated together; -1: this one alone
  int lost = 0;             ///< workers that ended while they ran it
};

/// What came of the tasks that were to do.
struct Dispatch {
  struct Failure {
    std::int64_t task = 0;
    TaskOutcome outcome{};
    std::string message;
  };

  std::array<std::int64_t, task_outcomes> finished{};  ///< by TaskOutcome
  std::vector<Failure> failures;                       ///< the first few
  std::int64_t left = 0;                               ///< not run, or abandoned: 0 unless stopped early
  int signal = 0;                                      ///< the signal that stopped it
  double busy_s = 0;                                   ///< of all workers
  double wall_s = 0;
};

class Master {
 public:
  /// `signal` tells the signal that this rank received, 0 for none. References must outlive the object.
  Master(Channel& channel, std::vector<PendingTask> tasks, Progress& progress, std::function<int()> signal);

  /// Deals with all messages that have arrived and hands out what it can.
  enum class Step { worked, waited, finished };
  Step step();

  /// Steps until all is finished, asleep between messages.
  void run();

  const Dispatch& dispatch() const { return dispatch_; }

 private:
  struct Worker {
    std::vector<PendingTask> tasks;  ///< the running one, then the one in hand
  };

  bool receive();
  void report(int rank, const Report& report);
  void stop(int signal);
  void hand_out();
  void assign(int rank);
  bool may_hold_another(const Worker& worker) const;
  bool next_goes_alone() const;

  Channel* channel_;
  Progress* progress_;
  std::function<int()> signal_;
  std::vector<PendingTask> pool_;  ///< by lost workers, then descending cost; [next_, end) is still to hand out
  std::size_t next_ = 0;
  double pool_cost_ = 0;
  std::vector<Worker> workers_;  ///< by rank; that of the master stays empty
  std::int64_t in_flight_ = 0;
  Progress::Clock::time_point begin_;
  Dispatch dispatch_;
};

}  // namespace rodsweep
