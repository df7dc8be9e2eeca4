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
// A worker that was not heard for too long (it hangs, died, or its host is cut off) is lost: its tasks go back to the
// others, as tasks that lost their workers, and so does what it finished and had not brought to disk. Nothing is sent
// to it, since Open MPI may end a rank that cannot reach another. Should it come back, it is told (Drop), gives up what
// it had and is welcome again. What it finished meanwhile has the same bits, whoever writes them last. Is nobody left
// for as long again, the sweep ends.
//
// On a signal, here or on a worker, nothing more is handed out and running tasks are abandoned; workers that have not
// given theirs up in good time are lost.
// With a time limit, no task is begun that would probably not end before it (time_budget.hpp); what runs then is
// abandoned. Where nothing of what is left would end within a whole limit either, the end says so. Every Assign is
// answered by one Report for each of its tasks; the workers are dismissed (Finish) when the last one is in. Are some
// lost by then, the others part without doing anything that would take all.
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

namespace rodsweep {

/// How long the master waits for workers; by default for ever.
struct Patience {
  std::chrono::duration<double> silence{std::numeric_limits<double>::infinity()};  ///< of any worker
  std::chrono::duration<double> drain{std::numeric_limits<double>::infinity()};    ///< after a request to stop
  TimeBudget time{};                                                               ///< of the whole start
  /// So often a task is begun. The first time it may have run beside the one that is to blame; the last time it is
  /// alone.
  int attempts = 3;
};

/// What the master tells its owner. Empty functions are not called.
struct Notices {
  std::function<void(int rank)> lost, found_again;
  /// Said before the workers have drained: mpirun kills all a second after its SIGTERM.
  std::function<void(int signal)> stopping;
  /// It was begun Patience::attempts times: to be written down. Returns what is said of it.
  std::function<std::string(std::int64_t task, int lost)> give_up;
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
  bool late = false;                                   ///< there was no time for what is left
  std::optional<PendingTask> too_long;                 ///< the longest of what is left, none of which would ever fit
  double too_long_s = 0;                               ///< what it is expected to take
  bool apart = false;                                  ///< workers are lost: nothing may be done that takes all ranks
  double busy_s = 0;                                   ///< of all workers
  double wall_s = 0;
};

class Master {
 public:
  /// `signal` tells the signal that this rank received, 0 for none. References must outlive the object.
  Master(Channel& channel, std::vector<PendingTask> tasks, Progress& progress, std::function<int()> signal,
         const Patience& patience = {}, Notices notices = {});

  /// Deals with all messages that have arrived and hands out what it can.
  enum class Step { worked, waited, finished };
  Step step();

  /// Steps until all is finished, asleep between messages.
  void run(const std::function<void()>& now_and_then = {});

  /// Of workers that part: until they have written all, or for as long as a stop may take. Those that do not say so
  /// are lost too.
  void wait_until_gone();

  const Dispatch& dispatch() const { return dispatch_; }

 private:
  using Clock = Progress::Clock;
  struct Finished {
    PendingTask task;
    Report report;
    bool counted;  ///< not where somebody else has it
  };

  struct Worker {
    std::vector<PendingTask> tasks;  ///< the running one, then the one in hand
    Clock::time_point heard;
    bool lost = false, told = false, gone = false;  ///< told: when it was heard again
    std::deque<Finished> unkept;                    ///< what it finished and would take along
    std::int64_t kept = 0, forgotten = 0;  ///< of all that it finished: on disk, as it says; no more in `unkept`
  };

  bool receive();
  void look_for_lost();
  void lose(int rank);
  void put_back(PendingTask task, bool begun);
  void report(int rank, const Report& report);
  void count(const PendingTask& task, const Report& report);
  void take_back(const PendingTask& task, const Report& report);
  static void forget_kept(Worker& worker);
  void stop(int signal);
  void hand_out();
  void assign(int rank);
  bool is_idle(int rank) const;
  bool any_left() const;
  bool may_hold_another(const Worker& worker) const;
  bool next_fits();
  void look_for_too_long();
  bool next_goes_alone() const;

  Channel* channel_;
  Progress* progress_;
  std::function<int()> signal_;
  Patience patience_;
  Notices notices_;
  std::vector<PendingTask> pool_;  ///< by lost workers, then descending cost; [next_, end) is still to hand out
  std::size_t next_ = 0;
  double pool_cost_ = 0;
  std::vector<Worker> workers_;  ///< by rank; that of the master stays empty
  std::int64_t in_flight_ = 0;
  bool stopping_ = false, nothing_fits_ = false;
  std::vector<PendingTask> given_up_;  ///< abandoned on a stop
  Clock::time_point begin_, stepped_, stopped_, last_heard_;
  Dispatch dispatch_;
};

}  // namespace rodsweep
