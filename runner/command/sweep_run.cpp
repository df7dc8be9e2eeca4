#include "runner/command/sweep_run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "runner/command/sweep_summary.hpp"
#include "runner/dispatch/master.hpp"
#include "runner/dispatch/mpi_channel.hpp"
#include "runner/dispatch/stop_signal.hpp"
#include "runner/experiment/loop_check.hpp"
#include "runner/experiment/task_body.hpp"
#include "runner/file/extension.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/results_file.hpp"
#include "runner/terminal/text.hpp"

namespace rodsweep {

namespace {

namespace fs = std::filesystem;

Plan plan_everywhere(const Job& job, const MpiSession& mpi) {
  std::optional<Plan> plan;
  collectively(mpi.world(), [&] {
    plan.emplace(job);
    check_loops(*plan);
  });
  return std::move(*plan);
}

/// Every rank looks for itself into the file to extend.
std::optional<Extension> open_extension(const RunOptions& options, const fs::path& path, const Plan& plan,
                                        const MpiSession& mpi) {
  std::optional<Extension> extension;
  if (!options.extend) return extension;
  collectively(mpi.world(), [&] {
    std::error_code error;
    if (fs::equivalent(*options.extend, path, error)) {
      throw FileError(fmt::format("{} is to be extended and cannot be the output too: name another file with -o FILE",
                                  path.native()));
    }
    extension.emplace(*options.extend, plan);
  });
  return extension;
}

std::string extension_text(const Extension& extension, std::int64_t total) {
  using Use = Extension::Use;
  return fmt::format("of {} tasks {} are copied from {}, {} get their new guesses, {} are run", total,
                     extension.count(Use::copy), extension.path().native(), extension.count(Use::complete),
                     extension.count(Use::run));
}

/// Creates the file, or opens it to go on; `before` (rank 0): what earlier starts did.
ResultsFile open_results(const RunOptions& options, const fs::path& path, const Plan& plan, const MpiSession& mpi,
                         const Placement& where, const std::optional<Extension>& extension, FileSummary& before) {
  bool continues = false;
  collectively(mpi.world(), [&] {
    if (mpi.rank() != 0) return;
    continues = options.resume && fs::exists(path);
    if (continues) before = inspect(path);
    if (continues && extension) extension->check_started(path);
  });
  continues = broadcast(continues ? 1 : 0, mpi.world()) != 0;

  Provenance provenance = provenance_of_this_process(options.command);
  provenance.job = fs::absolute(options.job).lexically_normal().native();
  provenance.ranks = mpi.size();
  provenance.oversubscribed = where.oversubscribed;
  std::optional<ResultsFile> file;
  collectively(mpi.world(), [&] {
    file = continues ? ResultsFile::resume(path, plan, provenance, mpi.world())
                     : ResultsFile::create(path, plan, provenance, mpi.world(), free_bytes,
                                           options.extend.value_or(fs::path()));
  });
  return std::move(*file);
}

std::vector<PendingTask> pending_tasks(const Plan& plan, const std::vector<std::uint8_t>& done,
                                       const std::optional<Extension>& extension) {
  // Tasks of an earlier file are looked at one by one.
  const std::vector<std::int64_t> batch =
      extension ? std::vector<std::int64_t>(static_cast<std::size_t>(plan.size()), -1) : batches(plan);
  std::vector<PendingTask> pending;
  for (const Task& task : plan.tasks())
    if (const auto i = static_cast<std::size_t>(task.index); !done[i])
      pending.push_back({task.index, task.cost * (extension ? extension->cost(task.index) : 1), batch[i]});
  return pending;
}

void advise(Console& console, const RunOptions& options, const Placement& where, std::size_t pending) {
  if (where.oversubscribed)
    console.warn(
        fmt::format("{} workers share {} cores: the times measured are worthless, and the file is marked so "
                    "(/runs/oversubscribed)",
                    where.workers, where.cores));
  else if (where.workers < where.cores && static_cast<std::size_t>(where.workers) < pending)
    console.note(fmt::format("{} of {} cores will work; for all of them: {}", where.workers, where.cores,
                             run_command(options, ranks_for(where.cores))));
}

/// Master and worker take turns in one process.
Dispatch dispatch_alone(std::vector<PendingTask> pending, Progress& progress, const StopSignal& signal,
                        BatchBody body) {
  const auto received = [&] { return signal.received(); };
  MemoryNetwork network(2);
  Master master(network[0], std::move(pending), progress, received);
  Worker worker(network[1], std::move(body), received, [&] { master.step(); });
  while (master.step() != Master::Step::finished) worker.step();
  return master.dispatch();
}

Dispatch dispatch_to_workers(const MpiSession& mpi, std::vector<PendingTask> pending, Progress& progress,
                             const StopSignal& signal, BatchBody body) {
  const auto received = [&] { return signal.received(); };
  MpiChannel channel(mpi.world());
  if (mpi.rank() > 0) {
    Worker(channel, std::move(body), received).run();
    return {};
  }
  Master master(channel, std::move(pending), progress, received);
  master.run();
  return master.dispatch();
}

}  // namespace

fs::path default_output(const std::string& job_name) { return fs::path("results") / (job_name + ".h5"); }

int ranks_for(int workers) { return workers > 1 ? workers + 1 : 1; }

std::string run_command(const RunOptions& options, int ranks) {
  std::string line;
  if (ranks > 1)
    line = fmt::format("mpirun --oversubscribe {}-n {} ", geteuid() == 0 ? "--allow-run-as-root " : "", ranks);
  line += fmt::format("{} run {}", shell_quoted(options.program), shell_quoted(options.job.native()));
  if (options.output) line += " -o " + shell_quoted(options.output->native());
  if (options.extend) line += " --extend " + shell_quoted(options.extend->native());
  if (options.resume) line += " --resume";
  return line;
}

ExitCode run_sweep(const RunOptions& options, const Job& job, const MpiSession& mpi, Console& console) {
  const Plan plan = plan_everywhere(job, mpi);
  const StopSignal signal;  // from here on a signal is a request, until the file is closed
  const fs::path path = options.output.value_or(default_output(plan.job().name));
  const Placement where = placement(mpi.world());
  const std::optional<Extension> extension = open_extension(options, path, plan, mpi);
  FileSummary before;
  ResultsFile file = open_results(options, path, plan, mpi, where, extension, before);
  if (!file.note().empty()) console.warn(file.note());

  std::vector<PendingTask> pending = pending_tasks(plan, file.done(), extension);
  advise(console, options, where, pending.size());
  const auto total = plan.size(), to_do = static_cast<std::int64_t>(pending.size());
  console.note(to_do == total ? fmt::format("{} tasks for {}, results in {}", total, plan.job().name, path.native())
                              : fmt::format("{} of {} tasks of {} are left to do in {}", to_do, total, plan.job().name,
                                            path.native()));
  if (extension) console.note(extension_text(*extension, total));
  if (extension && !extension->note().empty()) console.warn(extension->note());
  double cost = 0;
  for (const PendingTask& task : pending) cost += task.cost;
  Progress progress(console, {total, total - to_do, before.failed, cost, where.workers}, Progress::Clock::now());
  const WriteRecord write = [&](const Task& task, const TaskRecord& record, const TaskOrigin* origin) {
    file.write(task, record, origin);
  };
  const auto warn = [](const std::string& text) { Console(true).warn(text); };  // whichever rank finds the damage
  BatchBody body = extension ? extending_body(plan, *extension, write, warn) : task_body(plan, write);
  const Dispatch dispatch = mpi.size() == 1
                                ? dispatch_alone(std::move(pending), progress, signal, std::move(body))
                                : dispatch_to_workers(mpi, std::move(pending), progress, signal, std::move(body));

  const SweepSummary summary{total, before.done_by_outcome, dispatch, where.workers, path};
  const auto code = static_cast<ExitCode>(broadcast(static_cast<int>(exit_code(summary)), mpi.world()));
  if (mpi.rank() == 0) file.end_run(utc_now(), static_cast<int>(code));
  file.close();

  console.result(summary_text(summary));
  RunOptions again = options;
  again.resume = true;
  if (code == ExitCode::stopped)
    console.note(fmt::format("stopped early by {}; nothing is lost. To continue: {}", signal_name(dispatch.signal),
                             run_command(again, mpi.size())));
  return code;
}

}  // namespace rodsweep
