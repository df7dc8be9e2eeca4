// Runs a sweep or makes a data set: plans the job, creates or continues its file, dispatches its tasks, and prints a
// summary. Rank 0 is the master, the others are workers; a single rank is both.
#include "runner/command/run_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <functional>
#include <string_view>
#include <thread>
#include <utility>

#include "runner/command/launch.hpp"
#include "runner/command/next_line.hpp"
#include "runner/command/process_end.hpp"
#include "runner/command/sweep_summary.hpp"
#include "runner/command/sweep_tasks.hpp"
#include "runner/dispatch/master.hpp"
#include "runner/dispatch/mpi_channel.hpp"
#include "runner/dispatch/stop_signal.hpp"
#include "runner/file/extension.hpp"
#include "runner/file/file_reading.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/results_file.hpp"
#include "runner/file/runs.hpp"
#include "runner/file/unfinished_file.hpp"
#include "runner/measure/host_memory.hpp"
#include "runner/measure/inputs.hpp"
#include "runner/measure/task_body.hpp"
#include "runner/measure/training_sets.hpp"
#include "runner/terminal/text.hpp"

namespace rodsweep {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

/// Every rank opens the file to extend.
std::optional<Extension> open_extension(const RunOptions& options, const fs::path& path, const Plan& plan) {
  if (!options.extend) return std::nullopt;
  std::error_code error;
  if (fs::equivalent(*options.extend, path, error)) {
    throw FileError(fmt::format("{} is the file to extend and cannot be the output: name another file with -o FILE",
                                path.native()));
  }
  return Extension(*options.extend, plan);
}

std::string extension_text(const Extension& extension, std::int64_t total) {
  return fmt::format("{}: {} are copied from {}, {} are run", counted(total, "task"), extension.copied(),
                     extension.path().native(), total - extension.copied());
}

/// Throws FileError if the last run of the file ran another shard.
void check_shard(const fs::path& path, const Shard& shard) {
  const hdf5::File file = open_results(path);
  const std::vector<RunRow> runs = reading(path, [&] { return read_runs(file); });
  if (runs.empty() || runs.back().provenance.shard == 0) return;
  const Provenance& last = runs.back().provenance;
  if (last.shard != shard.number || last.shards != shard.of)
    throw FileError(fmt::format("{} holds shard {}/{}, not {}/{}: continue that one, or name another file with -o FILE",
                                path.native(), last.shard, last.shards, shard.number, shard.of));
}

/// Whether to continue an existing file, rather than create it.
bool has_begun(const RunOptions& options, const fs::path& path, const std::optional<Extension>& extension) {
  if (!options.resume || !fs::exists(path)) return false;
  if (extension) extension->check_started(path);
  if (options.shard) check_shard(path, *options.shard);
  return true;
}

/// Stores a task as crashed after its last allowed crash, and returns its message. Called on one rank.
std::string store_as_crashed(const Task& task, int crashes, const Plan& plan, ResultsFile& file) {
  TaskRecord record;
  record.prepare(task, axis_sizes(plan));
  record.outcome = TaskOutcome::crashed;
  record.message =
      crashes == 1
          ? "the worker or the sweep crashed or hung in the only try"
          : fmt::format(
                "the worker or the sweep crashed or hung in each of its {} tries; in the last try the task ran alone",
                crashes);
  file.write(task, record);
  return record.message;
}

void store_crashed_tasks(const Plan& plan, ResultsFile& file, int max_crashes) {
  for (const Task& task : plan.tasks())
    if (has_crashed(file, task.index, max_crashes))
      store_as_crashed(task, file.tries()[static_cast<std::size_t>(task.index)], plan, file);
  file.commit();
}

std::string begin_text(const std::string& name, const std::optional<Shard>& shard, std::int64_t total,
                       std::int64_t to_do, const fs::path& path) {
  if (shard) {
    const std::int64_t share = share_of(*shard, total);
    return fmt::format("shard {} of {} of {}, {} of {}{}, results in {}", shard->number, shard->of, name, share,
                       counted(total, "task"), to_do == share ? "" : fmt::format(", {} left to do", to_do),
                       path.native());
  }
  if (to_do == total) return fmt::format("{} for {}, results in {}", counted(total, "task"), name, path.native());
  return fmt::format("{} of {} of {} are left to do in {}", to_do, counted(total, "task"), name, path.native());
}

std::string too_large_text(const TooLarge& found, double memory) {
  return fmt::format(
      "task {} needs {} of memory for its results, but a rank has {} left: {} left out; {}, or record less (\"record\" "
      "in the job)",
      found.task, bytes_text(found.bytes), bytes_text(static_cast<std::int64_t>(memory)),
      found.tasks == 1 ? "it is" : counted(found.tasks, "such task") + " are", more_memory_text);
}

void advise(Console& console, const RunOptions& options, const Placement& where, std::size_t pending) {
  if (where.oversubscribed)
    console.warn(fmt::format(
        "{} workers share {} cores: the measured times are not valid; the file records this in /runs/oversubscribed",
        where.workers, where.cores));
  else if (where.workers < where.cores && static_cast<std::size_t>(where.workers) < pending) {
    RunOptions all = options;
    if (!is_launched() || options.workers) all.workers = where.cores;
    console.note(fmt::format("{} of {} cores are used; to use all: {}", where.workers, where.cores,
                             run_line(all, ranks_for(where.cores))));
  }
}

/// Counts tries in the file. A non-zero count on an incomplete task means that its worker crashed.
TaskBody counting_tries(TaskBody body, const Plan& plan, ResultsFile& file) {
  return [body = std::move(body), &plan, &file](std::int64_t index, const StopRequested& stop) {
    const Task task = plan.task(index);
    file.begin(task);
    // A failure within stop() (a sync, a message) is not the task's outcome.
    std::exception_ptr failure;
    const StopRequested checked_stop = [&] {
      try {
        return stop();
      } catch (...) {
        failure = std::current_exception();
        return true;
      }
    };
    try {
      TaskResult result = body(index, checked_stop);
      if (failure) std::rethrow_exception(failure);
      if (result.outcome == TaskOutcome::pending) file.abandon(task);
      return result;
    } catch (...) {  // this rank did not crash: the try does not count
      file.abandon(task);
      throw;
    }
  };
}

/// Master and worker take turns in one process.
Dispatch dispatch_alone(std::vector<PendingTask> pending, Progress& progress, const StopSignal& signal, TaskBody body,
                        const std::function<void()>& now_and_then, const Timeouts& timeouts) {
  const auto received = [&] { return signal.received(); };
  MemoryNetwork network(2);
  Timeouts alone;  // no rank to wait for
  alone.time_limit = timeouts.time_limit;
  alone.time_left = timeouts.time_left;
  Master master(network[0], std::move(pending), progress, received, alone);
  Worker worker(network[1], std::move(body), received, [&] {
    master.step();
    now_and_then();
  });
  while (master.step() != Master::Step::finished) worker.step();
  return master.dispatch();
}

/// With Open MPI's orte_enable_recovery, ranks exit independently, and MPI_Abort ends only the calling rank.
bool ranks_exit_alone() {
  const char* told = std::getenv("OMPI_MCA_orte_enable_recovery");
  return told != nullptr && std::string_view(told) != "0";
}

/// Exits a worker after ranks were lost, without MPI_Finalize, which would wait for them.
[[noreturn]] void exit_worker() {
  if (!ranks_exit_alone()) std::this_thread::sleep_for(std::chrono::minutes(1));  // until the master's MPI_Abort
  leave(ExitCode::ok);
}

/// The same for the master.
[[noreturn]] void exit_master(const MpiSession& mpi, ExitCode code) {
  process_ends();
  if (!ranks_exit_alone()) MPI_Abort(mpi.world(), static_cast<int>(code));
  leave(code);
}

Dispatch dispatch_to_workers(const MpiSession& mpi, std::vector<PendingTask> pending, Progress& progress,
                             const StopSignal& signal, TaskBody body, const std::function<void()>& now_and_then,
                             ResultsFile& file, const Timeouts& timeouts, const Callbacks& callbacks) {
  const auto received = [&] { return signal.received(); };
  MpiChannel channel(mpi.world());
  if (mpi.rank() > 0) {
    Worker worker(channel, std::move(body), received, now_and_then,
                  {std::min(Seconds(1), timeouts.silence / 5), [&] { return file.committed(); }});
    if (!worker.run()) return {};
    file.commit();
    channel.send(0, Gone{});
    exit_worker();
  }
  Master master(channel, std::move(pending), progress, received, timeouts, callbacks);
  master.run(now_and_then);
  if (master.dispatch().ranks_lost) {
    master.wait_until_gone();
    channel.abandon();
  }
  return master.dispatch();
}

/// The timeouts of a run that began at `begin`.
Timeouts timeouts_of(const RunOptions& options, Clock::time_point begin) {
  constexpr std::chrono::minutes drain{1};
  Timeouts timeouts;
  timeouts.drain = drain;
  timeouts.max_crashes = options.max_crashes;
  if (options.time_limit_s) {
    timeouts.time_limit = Seconds(*options.time_limit_s);
    timeouts.time_left = timeouts.time_limit - (Clock::now() - begin);
  }
  if (options.worker_timeout_s > 0) timeouts.silence = Seconds(options.worker_timeout_s);
  return timeouts;
}

std::string ended_text(const SweepSummary& summary, const RunOptions& options, int ranks) {
  const Dispatch& dispatch = summary.dispatch;
  RunOptions again = options;
  again.resume = true;
  if (dispatch.signal != 0) return stopped_text(dispatch.signal, again, ranks);
  if (dispatch.left == summary.too_large.tasks)
    return fmt::format("the remaining tasks do not fit into memory (see above). To continue with more memory: {}",
                       run_line(again, ranks));
  if (exit_code(summary) == ExitCode::too_long) {
    again.time_limit_s.reset();
    return fmt::format(
        "no task ended within the time limit of {}. To continue, raise --time-limit (under Slurm sbatch --time), or "
        "stop "
        "long tasks with --task-time-limit: {}",
        duration_text(*options.time_limit_s), run_line(again, ranks));
  }
  return fmt::format("{}; finished tasks are kept. To continue: {}",
                     dispatch.late ? "no time is left for the remaining tasks" : "all workers were lost",
                     run_line(again, ranks));
}

}  // namespace

ExitCode run_sweep(const RunOptions& options, const Job& job, const MpiSession& mpi, Console& console) {
  const auto begin = Clock::now();
  const Plan plan = collectively(mpi.world(), [&] {
    Plan made = checked_plan(job);
    if (options.task_time_limit_s) made.set_task_time_limit(*options.task_time_limit_s);
    return made;
  });
  collectively(mpi.world(), [&] { load_python(job); });
  const StopSignal signal;  // from here until the file is closed, a signal only requests a stop
  const fs::path path = collectively(mpi.world(), [&] { return output_of(options, job.name); });
  read_knn_sets(plan, mpi.world());
  const Placement where = placement(mpi.world());
  limit_memory(options.memory_limit_gb ? 1e9 * *options.memory_limit_gb
                                       : (1 - memory_reserve) * host_memory() / where.host_workers);
  if (const std::string left = unfinished_text(path); !left.empty()) console.warn(left);
  const auto extension = collectively(mpi.world(), [&] { return open_extension(options, path, plan); });
  const int begun =
      collectively(mpi.world(), [&] { return mpi.rank() == 0 && has_begun(options, path, extension) ? 1 : 0; });
  const bool continues = broadcast(begun, mpi.world()) != 0;
  const Provenance provenance = provenance_of(options, mpi, where);
  std::optional<Clock::time_point> first_verified;
  const auto verifying = [&] {
    constexpr double most_of_rest = 0.25;
    if (!first_verified) first_verified = Clock::now();
    const Seconds took = Clock::now() - *first_verified, planned = *first_verified - begin;
    if (signal.received() != 0) return Verify::stop;
    const double rest = options.time_limit_s.value_or(INFINITY) - planned.count();
    return took.count() > most_of_rest * rest ? Verify::enough : Verify::on;
  };
  std::optional<ResultsFile> opened = collectively(mpi.world(), [&] {
    return continues ? ResultsFile::resume(path, plan, provenance, mpi.world(),
                                           options.retry_failed ? Retry::failed : Retry::none, verifying)
                     : ResultsFile::create(path, plan, provenance, mpi.world(), free_bytes,
                                           options.extend ? std::vector{*options.extend} : std::vector<fs::path>());
  });
  if (!opened) {
    SweepSummary summary;
    Dispatch& none = summary.dispatch;
    none.left = plan.size(), none.signal = static_cast<int>(-least(-signal.received(), mpi.world()));
    console.note("stopped during the verification of the file: " + ended_text(summary, options, mpi.size()));
    return ExitCode::stopped;
  }
  ResultsFile& file = *opened;
  if (!file.note().empty()) console.warn(file.note());
  by_rank_0(mpi.world(), [&] { store_crashed_tasks(plan, file, options.max_crashes); });
  const FileSummary before =
      collectively(mpi.world(), [&] { return continues && mpi.rank() == 0 ? inspect(path) : FileSummary(); });

  std::vector<PendingTask> pending;
  if (mpi.rank() == 0)  // only the master sends tasks
    pending = pending_tasks(plan, file, extension, options.shard, options.max_crashes);
  advise(console, options, where, pending.size());
  const auto total = plan.size(), to_do = static_cast<std::int64_t>(pending.size());
  const double memory = least(memory_left(), mpi.world());
  const TooLarge too_large = leave_out_too_large(plan, pending, memory);
  const std::int64_t share = options.shard ? share_of(*options.shard, total) : total;
  console.note(begin_text(job.name, options.shard, total, to_do, path));
  if (too_large.tasks > 0) console.warn(too_large_text(too_large, memory));
  if (extension) console.note(extension_text(*extension, total));
  if (extension && !extension->note().empty()) console.warn(extension->note());

  double cost = 0;
  for (const PendingTask& task : pending) cost += task.cost;
  Progress progress(console, {share, share - to_do, before.failed, cost, where.workers}, Progress::Clock::now());
  const WriteRecord write = [&](const Task& task, const TaskRecord& record, const TaskOrigin* origin) {
    file.write(task, record, origin);
  };
  const auto warn = [](const std::string& text) { Console(true).warn(text); };  // the rank that finds the damage prints
  const auto hosts = everywhere(host_name(), mpi.world());
  Callbacks callbacks;
  callbacks.lost = [&](int rank) {
    console.warn(
        fmt::format("rank {} on {} timed out; its tasks are reassigned", rank, hosts[static_cast<std::size_t>(rank)]));
  };
  callbacks.stopping = [&](int number) {
    console.note(fmt::format("stopped by {}: finished tasks are kept, and --resume continues", signal_cause(number)));
  };
  callbacks.crashed = [&](std::int64_t task, int crashes) {
    return store_as_crashed(plan.task(task), crashes, plan, file);
  };
  TaskBody body =
      counting_tries(extension ? extending_body(plan, *extension, write, warn) : task_body(plan, write), plan, file);
  const auto now_and_then = [&] {
    file.commit_if_due();
    if (mpi.rank() == 0) file.beat(progress.seconds_left(Progress::Clock::now()));
  };
  const Timeouts timeouts = timeouts_of(options, begin);
  Dispatch dispatch =
      mpi.size() == 1 ? dispatch_alone(std::move(pending), progress, signal, std::move(body), now_and_then, timeouts)
                      : dispatch_to_workers(mpi, std::move(pending), progress, signal, std::move(body), now_and_then,
                                            file, timeouts, callbacks);
  dispatch.left += too_large.tasks;
  file.commit();

  SweepSummary summary{total, before.done_by_outcome, dispatch,  where.workers,
                       path,  options.program,        too_large, options.shard};
  const auto end = [&](ExitCode code) {
    if (mpi.rank() == 0) file.end_run(utc_now(), static_cast<int>(code));
    dispatch.ranks_lost ? file.leave() : file.close();
    by_rank_0(dispatch.ranks_lost ? std::nullopt : std::optional(mpi.world()), [&] {
      file.check_written();
      summary.solves = count_solves(path);
    });
    for (const Dispatch::Failure& of : dispatch.warnings) console.warn(fmt::format("task {}: {}", of.task, of.message));
    console.result(summary_text(summary));
    if (dispatch.left > 0) console.note(ended_text(summary, options, mpi.size()));
    return code;
  };
  if (dispatch.ranks_lost) {
    const ExitCode code = end(exit_code(summary));
    console.note("some ranks were lost; Open MPI stops the others");
    console.close();
    exit_master(mpi, code);
  }
  return end(static_cast<ExitCode>(broadcast(static_cast<int>(exit_code(summary)), mpi.world())));
}

}  // namespace rodsweep
