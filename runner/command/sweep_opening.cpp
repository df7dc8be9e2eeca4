#include "runner/command/sweep_opening.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "runner/command/commands.hpp"
#include "runner/file/file_reading.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/runs.hpp"
#include "runner/file/unfinished_file.hpp"
#include "runner/measure/host_memory.hpp"
#include "runner/measure/plan_check.hpp"
#include "runner/measure/shared_inputs.hpp"
#include "runner/terminal/formats.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

using Seconds = std::chrono::duration<double>;

Plan plan_of(const RunOptions& options, const Job& job) {
  Plan plan = checked_plan(job);
  if (options.task_time_limit_s) plan.set_task_time_limit(*options.task_time_limit_s);
  load_python(job);
  return plan;
}

double memory_limit(const RunOptions& options, const Placement& where) {
  if (options.memory_limit_gb) return 1e9 * *options.memory_limit_gb;
  return (1 - memory_reserve) * host_memory() / where.host_workers;
}

/// Every rank opens the file to extend.
std::optional<Extension> open_extension(const RunOptions& options, const fs::path& path, const Plan& plan) {
  if (!options.extend) return std::nullopt;
  std::error_code error;
  if (fs::equivalent(*options.extend, path, error)) {
    throw FileError("{} is the file to extend and cannot be the output: name another file with -o FILE", path.native());
  }
  return Extension(*options.extend, plan);
}

/// Throws FileError if the last run of the file ran another shard.
void check_shard(const fs::path& path, const Shard& shard) {
  const hdf5::File file = open_results(path);
  const std::vector<RunRow> runs = reading(path, [&] { return read_runs(file); });
  if (runs.empty() || runs.back().provenance.shard == 0) return;
  const Provenance& last = runs.back().provenance;
  if (last.shard != shard.number || last.shards != shard.of)
    throw FileError("{} holds shard {}/{}, not {}/{}: continue that one, or name another file with -o FILE",
                    path.native(), last.shard, last.shards, shard.number, shard.of);
}

/// Whether to continue an existing file, rather than create it. Rank 0 decides.
bool continues_file(const Sweep& sweep) {
  bool begun = false;
  by_rank_0(sweep.mpi.world(), [&] {
    if (!sweep.options.resume || !fs::exists(sweep.path)) return;
    if (sweep.extension) sweep.extension->check_started(sweep.path);
    if (sweep.options.shard) check_shard(sweep.path, *sweep.options.shard);
    begun = true;
  });
  return broadcast(begun ? 1 : 0, sweep.mpi.world()) != 0;
}

/// Ends the verification of a file at a signal, or after a quarter of the time that planning left.
std::function<Verify()> verification_limit(const Sweep& sweep) {
  return [&sweep, first = std::optional<Sweep::Clock::time_point>()]() mutable {
    constexpr double most_of_rest = 0.25;
    if (!first) first = Sweep::Clock::now();
    if (sweep.signal.received() != 0) return Verify::stop;
    const Seconds took = Sweep::Clock::now() - *first, planned = *first - sweep.begin;
    const double rest = sweep.options.time_limit_s.value_or(INFINITY) - planned.count();
    return took.count() > most_of_rest * rest ? Verify::enough : Verify::on;
  };
}

std::optional<ResultsFile> open_file(const Sweep& sweep, const Provenance& provenance, bool continues) {
  const RunOptions& options = sweep.options;
  const MPI_Comm world = sweep.mpi.world();
  if (continues)
    return ResultsFile::resume(sweep.path, sweep.plan, provenance, world,
                               options.retry_failed ? Retry::failed : Retry::none, verification_limit(sweep));
  return ResultsFile::create(sweep.path, sweep.plan, provenance, world, free_bytes,
                             options.extend ? std::vector{*options.extend} : std::vector<fs::path>());
}

/// Stores tasks that crashed in all their tries, and lists the tasks of this run, whatever memory they need.
std::vector<PendingTask> remaining_tasks(const Sweep& sweep, ResultsFile& file) {
  std::vector<PendingTask> tasks = all_tasks(sweep.plan, file.tries(), sweep.extension);
  leave_out(tasks, not_done(file.done()));
  for (const PendingTask& crashed : leave_out(tasks, not_crashed(sweep.options.max_crashes)))
    store_as_crashed(sweep.plan.task(crashed.index), crashed.crashes, sweep.plan, file);
  file.commit();
  leave_out(tasks, in_shard(sweep.plan, sweep.options.shard));
  return tasks;
}

std::string begin_text(const Sweep& sweep, std::int64_t to_do) {
  const std::string &name = sweep.job.name, &path = sweep.path.native();
  const std::int64_t total = sweep.plan.size();
  if (const auto& shard = sweep.options.shard) {
    const std::int64_t share = share_of(*shard, total);
    return fmt::format("shard {} of {} of {}, {} of {}{}, results in {}", shard->number, shard->of, name, share,
                       count_text(total, "task"), to_do == share ? "" : fmt::format(", {} left to do", to_do), path);
  }
  if (to_do == total) return fmt::format("{} for {}, results in {}", count_text(total, "task"), name, path);
  return fmt::format("{} of {} of {} are left to do in {}", to_do, count_text(total, "task"), name, path);
}

std::string too_large_text(const TooLarge& found, double memory) {
  return fmt::format(
      "task {} needs {} of memory for its results, but a rank has {} left: {} left out; {}, or record less (\"record\" "
      "in the job)",
      found.task, bytes_text(found.bytes), bytes_text(static_cast<std::int64_t>(memory)),
      found.tasks == 1 ? "it is" : count_text(found.tasks, "such task") + " are", more_memory_text);
}

std::string extension_text(const Extension& extension, std::int64_t total) {
  return fmt::format("{}: {} are copied from {}, {} are run", count_text(total, "task"), extension.copied(),
                     extension.path().native(), total - extension.copied());
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

}  // namespace

Sweep::Sweep(const RunOptions& with, const Job& of, const MpiSession& session, Console& output)
    : options(with),
      job(of),
      mpi(session),
      console(output),
      plan(collectively(mpi.world(), [&] { return plan_of(options, job); })),
      path(collectively(mpi.world(), [&] { return output_of(options, job.name); })) {}

bool open_sweep(Sweep& sweep) {
  const RunOptions& options = sweep.options;
  const Plan& plan = sweep.plan;
  const MPI_Comm world = sweep.mpi.world();
  Console& console = sweep.console;
  SweepSummary& summary = sweep.summary;

  read_knn_sets(plan, world);
  const Placement where = placement(world);
  limit_memory(memory_limit(options, where));
  summary = {plan.size(), {}, {}, where.workers, sweep.path, options.program, {}, options.shard};

  if (const std::string left = unfinished_text(sweep.path); !left.empty()) console.warn(left);
  sweep.extension = collectively(world, [&] { return open_extension(options, sweep.path, plan); });
  const bool continues = continues_file(sweep);
  const Provenance provenance = provenance_of(options, sweep.mpi, where);
  sweep.file = collectively(world, [&] { return open_file(sweep, provenance, continues); });
  if (!sweep.file) {
    summary.dispatch.left = plan.size();
    summary.dispatch.signal = static_cast<int>(-min_over_ranks(-sweep.signal.received(), world));
    return false;
  }
  if (!sweep.file->note().empty()) console.warn(sweep.file->note());

  by_rank_0(world, [&] {
    sweep.tasks = remaining_tasks(sweep, *sweep.file);
    if (!continues) return;
    const FileSummary before = inspect(sweep.path);
    summary.before = before.done_by_outcome;
    sweep.failed_before = before.failed;
  });
  const std::size_t to_do = sweep.tasks.size();
  const double memory = min_over_ranks(memory_left(), world);
  summary.too_large = largest_of(leave_out(sweep.tasks, fits_memory(plan, memory)), plan);

  advise(console, options, where, to_do);
  console.note(begin_text(sweep, static_cast<std::int64_t>(to_do)));
  if (summary.too_large.tasks > 0) console.warn(too_large_text(summary.too_large, memory));
  if (sweep.extension) console.note(extension_text(*sweep.extension, plan.size()));
  if (sweep.extension && !sweep.extension->note().empty()) console.warn(sweep.extension->note());
  return true;
}

std::vector<PendingTask> all_tasks(const Plan& plan, const std::vector<std::uint8_t>& tries,
                                   const std::optional<Extension>& extension) {
  std::vector<PendingTask> tasks;
  for (const Task& task : plan.tasks())
    tasks.push_back({task.index, task.cost * (extension ? extension->cost(task.index) : 1),
                     tries[static_cast<std::size_t>(task.index)]});
  return tasks;
}

std::vector<PendingTask> leave_out(std::vector<PendingTask>& tasks, const TaskFilter& stays) {
  const auto end = std::stable_partition(tasks.begin(), tasks.end(), stays);
  std::vector<PendingTask> left_out(end, tasks.end());
  tasks.erase(end, tasks.end());
  return left_out;
}

TaskFilter not_done(const std::vector<std::uint8_t>& done) {
  return [&done](const PendingTask& task) { return done[static_cast<std::size_t>(task.index)] == 0; };
}

TaskFilter not_crashed(int max_crashes) {
  return [max_crashes](const PendingTask& task) { return task.crashes < max_crashes; };
}

TaskFilter in_shard(const Plan& plan, const std::optional<Shard>& shard) {
  if (!shard) return [](const PendingTask&) { return true; };
  std::vector<std::int64_t> order(static_cast<std::size_t>(plan.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int64_t a, std::int64_t b) { return plan.cost(a) > plan.cost(b); });
  std::vector<bool> mine(order.size(), false);
  for (auto i = static_cast<std::size_t>(shard->number) - 1; i < order.size(); i += static_cast<std::size_t>(shard->of))
    mine[static_cast<std::size_t>(order[i])] = true;
  return [mine = std::move(mine)](const PendingTask& task) { return mine[static_cast<std::size_t>(task.index)]; };
}

TaskFilter fits_memory(const Plan& plan, double memory) {
  return [&plan, memory, of_a_row = row_bytes(axis_sizes(plan))](const PendingTask& task) {
    return static_cast<double>(record_bytes(plan.task(task.index), of_a_row)) <= memory;
  };
}

TooLarge largest_of(const std::vector<PendingTask>& tasks, const Plan& plan) {
  const PerRows<std::int64_t> of_a_row = row_bytes(axis_sizes(plan));
  TooLarge found;
  for (const PendingTask& task : tasks) {
    ++found.tasks;
    const std::int64_t bytes = record_bytes(plan.task(task.index), of_a_row);
    if (bytes > found.bytes) found.task = task.index, found.bytes = bytes;
  }
  return found;
}

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

}  // namespace rodsweep
