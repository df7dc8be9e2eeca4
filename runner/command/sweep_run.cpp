// Runs a sweep or makes a data set: open, dispatch, finish. Each part is collective. Rank 0 is the master, the others are
// workers; a single rank is both.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "runner/command/process_end.hpp"
#include "runner/command/sweep_opening.hpp"
#include "runner/dispatch/channel.hpp"
#include "runner/measure/task_runner.hpp"

namespace rodsweep {
namespace {

using Seconds = std::chrono::duration<double>;

/// Runs tasks, and counts tries in the file. A non-zero count on an incomplete task means that its worker crashed.
TaskBody body_of(Sweep& sweep) {
  ResultsFile& file = *sweep.file;
  TaskRunner run(sweep.plan, [&file](const Task& task, const TaskRecord& record, const TaskOrigin* origin) {
    file.write(task, record, origin);
  });
  if (sweep.extension)  // the rank that finds the damage prints
    run.copy_from(*sweep.extension, [](const std::string& text) { Console(true).warn(text); });
  return [&sweep, &file, run = std::move(run)](std::int64_t index, const StopRequested& stop) mutable {
    const Task task = sweep.plan.task(index);
    file.begin(task);
    try {
      TaskResult result = run(index, stop);
      if (result.outcome == TaskOutcome::pending) file.abandon(task);
      return result;
    } catch (...) {  // this rank did not crash: the try does not count
      file.abandon(task);
      throw;
    }
  };
}

Progress progress_of(const Sweep& sweep) {
  const SweepSummary& summary = sweep.summary;
  const std::int64_t share = summary.shard ? share_of(*summary.shard, summary.tasks) : summary.tasks;
  const std::int64_t to_do = static_cast<std::int64_t>(sweep.tasks.size()) + summary.too_large.tasks;
  double cost = 0;
  for (const PendingTask& task : sweep.tasks) cost += task.cost;
  return {sweep.console, {share, share - to_do, sweep.failed_before, cost, summary.workers}, Progress::Clock::now()};
}

Timeouts timeouts_of(const RunOptions& options, Sweep::Clock::time_point begin) {
  constexpr std::chrono::minutes drain{1};
  Timeouts timeouts;
  timeouts.drain = drain;
  timeouts.max_crashes = options.max_crashes;
  if (options.time_limit_s) {
    timeouts.time_limit = Seconds(*options.time_limit_s);
    timeouts.time_left = timeouts.time_limit - (Sweep::Clock::now() - begin);
  }
  if (options.worker_timeout_s > 0) timeouts.silence = Seconds(options.worker_timeout_s);
  return timeouts;
}

Callbacks callbacks_of(Sweep& sweep) {
  Callbacks callbacks;
  callbacks.lost = [&sweep, hosts = gather_to_all(host_name(), sweep.mpi.world())](int rank) {
    sweep.console.warn(
        fmt::format("rank {} on {} timed out; its tasks are reassigned", rank, hosts[static_cast<std::size_t>(rank)]));
  };
  callbacks.stopping = [&sweep](int number) {
    sweep.console.note(
        fmt::format("stopped by {}: finished tasks are kept, and --resume continues", signal_cause(number)));
  };
  callbacks.crashed = [&sweep](std::int64_t task, int crashes) {
    return store_as_crashed(sweep.plan.task(task), crashes, sweep.plan, *sweep.file);
  };
  return callbacks;
}

/// A failed heartbeat is a warning, given once, because the results do not depend on it.
void beat(Sweep& sweep, const Progress& progress, bool& warned) try {
  sweep.file->beat(progress.seconds_left(Progress::Clock::now()));
} catch (const Hdf5Error& error) {
  if (!std::exchange(warned, true)) sweep.console.warn(fmt::format("the heartbeat failed: {}", error.what()));
}

/// Master and worker take turns in one process.
Dispatch dispatch_in_process(Sweep& sweep, Progress& progress, const std::function<void()>& now_and_then) {
  const auto received = [&] { return sweep.signal.received(); };
  MemoryNetwork network(2);
  Timeouts timeouts = timeouts_of(sweep.options, sweep.begin);
  timeouts.silence = timeouts.drain = Timeouts::never;  // no rank to wait for
  Master master(network[0], std::move(sweep.tasks), progress, received, timeouts);
  Worker worker(network[1], body_of(sweep), received, [&] {
    master.step();
    now_and_then();
  });
  while (master.step() != Master::Step::finished) worker.step();
  return master.dispatch();
}

/// On rank 0.
Dispatch dispatch_to_workers(Sweep& sweep, Progress& progress, const Callbacks& callbacks,
                             const std::function<void()>& now_and_then) {
  MpiChannel channel(sweep.mpi.world());
  Master master(
      channel, std::move(sweep.tasks), progress, [&] { return sweep.signal.received(); },
      timeouts_of(sweep.options, sweep.begin), callbacks);
  master.run(now_and_then);
  if (master.dispatch().ranks_lost) {
    master.wait_until_gone();
    channel.abandon();
  }
  return master.dispatch();
}

/// On the other ranks. Ends the process if ranks were lost.
void work(Sweep& sweep, const std::function<void()>& now_and_then) {
  ResultsFile& file = *sweep.file;
  MpiChannel channel(sweep.mpi.world());
  const Seconds silence = timeouts_of(sweep.options, sweep.begin).silence;
  Worker worker(channel, body_of(sweep), [&] { return sweep.signal.received(); }, now_and_then,
                {std::min(Seconds(1), silence / 5), [&] { return file.committed(); }});
  if (!worker.run()) return;
  file.commit();
  channel.send(0, Gone{});
  leave_lost_ranks(sweep.mpi, ExitCode::ok);
}

/// Runs the tasks and writes their results, until all are done or the run is stopped. Sets summary.dispatch. If ranks were
/// lost, only rank 0 returns.
void dispatch_sweep(Sweep& sweep) {
  const MpiSession& mpi = sweep.mpi;
  Progress progress = progress_of(sweep);
  const Callbacks callbacks = callbacks_of(sweep);
  bool warned = false;
  const auto now_and_then = [&] {
    sweep.file->commit_if_due();
    if (mpi.rank() == 0) beat(sweep, progress, warned);
  };
  Dispatch& dispatch = sweep.summary.dispatch;
  if (mpi.rank() > 0)
    work(sweep, now_and_then);
  else if (mpi.size() > 1)
    dispatch = dispatch_to_workers(sweep, progress, callbacks, now_and_then);
  else
    dispatch = dispatch_in_process(sweep, progress, now_and_then);
  dispatch.left += sweep.summary.too_large.tasks;
  sweep.file->commit();
}

/// Closes the file and prints the summary. Ends the process if ranks were lost.
ExitCode finish_sweep(Sweep& sweep) {
  const MpiSession& mpi = sweep.mpi;
  Console& console = sweep.console;
  const Dispatch& dispatch = sweep.summary.dispatch;
  ExitCode code = exit_code(sweep.summary);
  if (!dispatch.ranks_lost) code = static_cast<ExitCode>(broadcast(static_cast<int>(code), mpi.world()));

  if (mpi.rank() == 0) sweep.file->end_run(utc_now(), static_cast<int>(code));
  dispatch.ranks_lost ? sweep.file->leave() : sweep.file->close();
  by_rank_0(dispatch.ranks_lost ? std::nullopt : std::optional(mpi.world()), [&] {
    sweep.file->check_written();
    sweep.summary.solves = count_solves(sweep.path);
  });

  for (const Dispatch::Failure& of : dispatch.warnings) console.warn(fmt::format("task {}: {}", of.task, of.message));
  console.result(summary_text(sweep.summary));
  if (dispatch.left > 0) console.note(ended_text(sweep.summary, sweep.options, mpi.size()));
  if (!dispatch.ranks_lost) return code;
  console.note("some ranks were lost; Open MPI stops the others");
  console.close();
  leave_lost_ranks(mpi, code);
}

}  // namespace

ExitCode run_sweep(const RunOptions& options, const Job& job, const MpiSession& mpi, Console& console) {
  Sweep sweep(options, job, mpi, console);
  if (!open_sweep(sweep)) {
    console.note("stopped during the verification of the file: " + ended_text(sweep.summary, options, mpi.size()));
    return ExitCode::stopped;
  }
  dispatch_sweep(sweep);
  return finish_sweep(sweep);
}

}  // namespace rodsweep
