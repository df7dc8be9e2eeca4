// Assigns the tasks of a sweep to workers: longest first (by cost, ties by index), one to each idle worker.
//
// A worker that runs a task gets a second one only if enough tasks are left: they must keep all workers busy for at
// least twice the time of both its tasks (by cost). So no worker waits for an assignment in mid-sweep, and at the end
// no task waits behind a running one while another worker is idle.
//
// A worker whose heartbeat times out (it hangs, died, or its host is disconnected) is lost for the rest of the run. Its
// tasks are reassigned, also finished ones that are not on disk. Tasks that were running on lost workers are retried
// after all others. A task that may crash only once more runs alone in the sweep.
// The master sends nothing to a lost rank, because Open MPI may abort a rank that cannot reach another. If a lost
// worker sends again, its reports are ignored (a rewritten result has the same bits), and it is dismissed with the
// others. If all workers are lost, the sweep ends.
//
// After a signal to any rank, no more tasks are assigned and running ones are abandoned. Workers that do not report
// this within the drain timeout are lost. The same happens at the time limit of the run. If planning and opening the
// file took all of that time, the cheapest task runs all the same, for at most the time limit, so that every run tries
// one.
// Each Assign is answered by one Report per task; workers are dismissed (Finish) after the last Report.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "runner/dispatch/channel.hpp"
#include "runner/terminal/progress.hpp"
#include "solver/step/stopwatch.hpp"

namespace rodsweep {

/// A task not yet done.
struct PendingTask {
  std::int64_t index = 0;
  double cost = 0;
  int crashes = 0;  ///< workers lost while running it
};

struct Timeouts {
  using Seconds = std::chrono::duration<double>;
  static constexpr Seconds never{std::numeric_limits<double>::infinity()};

  Seconds silence = never;     ///< without a worker's heartbeat
  Seconds drain = never;       ///< after a request to stop
  Seconds time_limit = never;  ///< of the whole run
  Seconds time_left = never;   ///< of the time limit
  int max_crashes = 3;         ///< a task is not retried after this many worker deaths
};

/// Called by the master while it runs; empty functions are skipped.
struct Callbacks {
  std::function<void(int rank)> lost;
  /// Called before the workers drain, because mpirun kills all ranks one second after SIGTERM.
  std::function<void(int signal)> stopping;
  /// Called for a task that reaches Timeouts::max_crashes. Stores it as crashed and returns its message.
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
  std::vector<Failure> warnings;                       ///< of tasks that are ok: the first few different ones
  std::int64_t left = 0;                               ///< not run or abandoned; 0 unless stopped early
  int signal = 0;                                      ///< the signal that stopped the sweep
  bool late = false;                                   ///< stopped by the time limit
  bool ranks_lost = false;                             ///< no collective call may follow
  double busy_s = 0;                                   ///< of all workers
  double wall_s = 0;
};

class Master {
 public:
  /// `signal` returns the signal that this rank received, 0 for none. References must outlive the object.
  Master(Channel& channel, std::vector<PendingTask> tasks, Progress& progress, std::function<int()> signal,
         const Timeouts& timeouts = {}, Callbacks callbacks = {}, TimeSource now = std::chrono::steady_clock::now);

  /// Handles all arrived messages and assigns tasks.
  enum class Step { worked, waited, finished };
  Step step();

  /// Calls step() until it returns `finished`; sleeps between messages.
  void run(const std::function<void()>& now_and_then = {});

  /// Waits for Gone from all workers, at most for the drain timeout. The other workers are lost.
  void wait_until_gone();

  const Dispatch& dispatch() const { return dispatch_; }

 private:
  struct Finished {
    PendingTask task;
    Report report;
  };

  struct Worker {
    std::vector<PendingTask> tasks;  ///< the running task, then the next
    TimePoint heard;
    bool lost = false, heard_again = false, gone = false;
    std::deque<Finished> unsaved;         ///< finished, but not confirmed on disk
    std::int64_t saved = 0, removed = 0;  ///< finished tasks: confirmed on disk; removed from `unsaved`

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
  void warn(std::int64_t task, std::string_view text);
  static void remove_saved(Worker& worker);
  void stop(int signal);
  void assign_tasks();
  void assign(int rank);
  bool is_idle(int rank) const;
  bool any_worker_left() const;
  bool may_hold_another(const Worker& worker) const;
  bool has_next() const;
  bool is_late() const;
  bool next_runs_alone() const;

  Channel* channel_;
  Progress* progress_;
  std::function<int()> signal_;
  Timeouts timeouts_;
  Callbacks callbacks_;
  TimeSource now_;
  std::vector<PendingTask> pool_;  ///< by crashes, then descending cost; [next_, end) is unassigned
  std::size_t next_ = 0;
  double pool_cost_ = 0;
  std::vector<Worker> workers_;  ///< by rank; the master's entry is unused
  std::int64_t in_flight_ = 0;
  bool stopping_ = false;
  bool runs_only_one_;  ///< no time was left at the start
  TimePoint begin_, stepped_, stopped_;
  Dispatch dispatch_;
};

}  // namespace rodsweep
