// Assigns the tasks of a sweep to workers: longest first (by cost, ties by number), one to each idle worker. Tasks that
// are evaluated together are assigned together, as many as a batch holds.
//
// A worker gets a second task while it runs the first only if the tasks that are left keep all workers busy for at
// least twice as long as both of its tasks take (by cost). So no worker waits for an assignment in mid-sweep, and at
// the end no task waits behind a running one while another worker idles.
//
// A worker whose heartbeat stops (it hangs, died, or its host is cut off) is lost for the rest of the run. Its tasks
// are reassigned, and so are those that it finished and had not brought to disk. Tasks that were running on lost
// workers come after all others; from the last allowed crash on, they run one at a time, with nothing beside them. The
// master sends nothing to a silent rank, since Open MPI may end a rank that cannot reach another. If a lost worker is
// heard again, its reports are ignored (results have the same bits, whoever writes them last), and it is dismissed with
// the others. If no worker is left, the sweep ends.
//
// On a signal, here or on a worker, no more tasks are assigned and running ones are abandoned. Workers that do not
// report this within the drain timeout are lost.
// With a time limit, no task is begun that would probably not end before it (time_budget.hpp), and running tasks are
// abandoned when it is over. Every Assign is answered by one Report for each of its tasks; workers are dismissed
// (Finish) after the last one.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "runner/dispatch/channel.hpp"
#include "runner/dispatch/pending_task.hpp"
#include "runner/dispatch/time_budget.hpp"
#include "runner/terminal/progress.hpp"
#include "solver/step/stopwatch.hpp"

namespace rodsweep {

struct Timeouts {
  std::chrono::duration<double> silence{std::numeric_limits<double>::infinity()};  ///< without a worker's heartbeat
  std::chrono::duration<double> drain{std::numeric_limits<double>::infinity()};    ///< after a request to stop
  TimeBudget time{};                                                               ///< of the whole run
  int max_crashes = 3;  ///< a task that loses so many workers is not tried again
};

/// What the master reports while it runs. Empty functions are not called.
struct Callbacks {
  std::function<void(int rank)> lost;
  /// Called before the workers have drained: mpirun kills all ranks a second after its SIGTERM.
  std::function<void(int signal)> stopping;
  /// A task has reached Timeouts::max_crashes. Stores it as crashed and returns its message.
  std::function<std::string(std::int64_t task, int crashes)> crashed;
};

/// The state of the sweep's tasks.
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
  bool late = false;                                   ///< stopped since no time is left for the rest
  std::optional<PendingTask> too_long;                 ///< if no task that is left would ever fit: the longest
  double too_long_s = 0;                               ///< its expected time
  bool ranks_lost = false;                             ///< no collective call may follow
  double busy_s = 0;                                   ///< of all workers
  double wall_s = 0;
};

class Master {
 public:
  /// `signal` returns the signal that this rank received, 0 for none. References must outlive the object.
  Master(Channel& channel, std::vector<PendingTask> tasks, Progress& progress, std::function<int()> signal,
         const Timeouts& timeouts = {}, Callbacks callbacks = {}, TimeSource now = std::chrono::steady_clock::now);

  /// Handles all messages that have arrived and assigns what it can.
  enum class Step { worked, waited, finished };
  Step step();

  /// Steps until all is finished, and sleeps between messages.
  void run(const std::function<void()>& now_and_then = {});

  /// Waits until all workers have said Gone, at most for the drain timeout. Workers that have not are lost.
  void wait_until_gone();

  const Dispatch& dispatch() const { return dispatch_; }

 private:
  struct Finished {
    PendingTask task;
    Report report;
  };

  struct Worker {
    std::vector<PendingTask> tasks;  ///< the running one, then the next
    TimePoint heard;
    bool lost = false, heard_again = false, gone = false;
    std::deque<Finished> unsaved;         ///< finished, and not known to be on disk
    std::int64_t saved = 0, removed = 0;  ///< of all that it finished: on disk; no more in `unsaved`

    bool reachable() const { return !lost || heard_again; }
  };

  Worker& worker(int rank) { return workers_[static_cast<std::size_t>(rank)]; }
  bool receive();
  void find_lost();
  void lose(int rank);
  void put_back(PendingTask task, bool crashed);
  void report(int rank, const Report& report);
  void count(const PendingTask& task, const Report& report);
  void uncount(const PendingTask& task, const Report& report);
  static void remove_saved(Worker& worker);
  void stop(int signal);
  void assign_tasks();
  void assign(int rank);
  bool is_idle(int rank) const;
  bool any_worker_left() const;
  bool may_hold_another(const Worker& worker) const;
  bool next_fits();
  void find_too_long();
  bool next_runs_alone() const;

  Channel* channel_;
  Progress* progress_;
  std::function<int()> signal_;
  Timeouts timeouts_;
  Callbacks callbacks_;
  TimeSource now_;
  std::vector<PendingTask> pool_;  ///< by crashes, then descending cost; [next_, end) is not assigned
  std::size_t next_ = 0;
  double pool_cost_ = 0;
  std::vector<Worker> workers_;  ///< by rank; that of the master stays empty
  std::int64_t in_flight_ = 0;
  bool stopping_ = false, nothing_fits_ = false;
  std::vector<PendingTask> abandoned_;
  TimePoint begin_, stepped_, stopped_;
  Dispatch dispatch_;
};

}  // namespace rodsweep
