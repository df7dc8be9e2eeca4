// The commands `rerun` and `systems`: one task of a results file is run again from the job in that file.
#include <fmt/format.h>
#include <mpi.h>

#include "runner/command/commands.hpp"
#include "runner/command/run_command.hpp"
#include "runner/dispatch/stop_signal.hpp"
#include "runner/file/results_file.hpp"
#include "runner/file/stored_plan.hpp"
#include "runner/file/systems_file.hpp"
#include "runner/file/unfinished_file.hpp"
#include "runner/measure/task_runner.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

struct StoredTask {
  Plan whole;   ///< of the file
  Plan single;  ///< of the task
};

/// Throws FileError, with advice, if the file does not have the task, is itself a rerun, or is of another machine.
StoredTask stored_task(const fs::path& file, std::int64_t task, int trajectory_every) {
  const FileSummary summary = inspect(file);
  if (summary.rerun_of_task)
    throw FileError("{} holds only task {} of a sweep, from `rodsweep rerun`: use the file of the sweep", file.native(),
                    *summary.rerun_of_task);
  if (task < 0 || task >= summary.tasks)
    throw FileError("{} has no task {}: must be from 0 to {}", file.native(), task, summary.tasks - 1);
  Plan whole = stored_plan(summary);
  check_same_tasks(file, whole);
  Plan single = whole.single_task(task, trajectory_every);
  return {std::move(whole), std::move(single)};
}

/// The new file, beside the old one unless the user chose another.
template <class Options>
fs::path output_of(const Options& options, const char* what, Console& console) {
  fs::path output = options.output.value_or(file_beside(options.file, fmt::format("-{}-{}", what, options.task)));
  refuse_existing(output);
  if (const std::string left = unfinished_text(output); !left.empty()) console.warn(left);
  return output;
}

/// None, with a note, if a signal stopped it.
std::optional<TaskResult> run_task_here(TaskRunner run, const StopSignal& signal, Console& console) {
  TaskResult result = run(0, [&] { return signal.received() != 0; });
  if (result.outcome != TaskOutcome::pending) return result;
  console.note(fmt::format("stopped early by {}; nothing was written", signal_cause(signal.received())));
  return std::nullopt;
}

/// "task 3: timed_out: the reason".
std::string result_text(std::int64_t task, const TaskResult& result) {
  return fmt::format("task {}: {}{}", task, to_string(result.outcome),
                     result.message.empty() ? "" : ": " + result.message);
}

ExitCode code_of(TaskOutcome outcome) { return outcome == TaskOutcome::ok ? ExitCode::ok : ExitCode::tasks_failed; }

}  // namespace

ExitCode execute(const RerunOptions& options, Console& console) {
  const StopSignal signal;
  const StoredTask stored = stored_task(options.file, options.task, options.trajectory_every);
  const Plan& plan = stored.single;
  const fs::path output = output_of(options, "task", console);
  Provenance provenance = provenance_of_this_process(options.command);
  provenance.job = plan.job().path.native();
  const Task task = plan.task(0);
  console.note(
      fmt::format("task {}: {} segments, {} steps, {} frames", options.task, task.segments, task.steps, task.frames));
  const auto write = [&](const Task& done, const TaskRecord& record, const TaskOrigin*) {
    ResultsFile file = ResultsFile::create(output, plan, provenance, MPI_COMM_SELF);
    file.write(done, record);
    file.end_run(utc_now(), static_cast<int>(code_of(record.outcome)));
    file.close();
    file.check_written();
  };
  const auto result = run_task_here(TaskRunner(plan, write), signal, console);
  if (!result) return ExitCode::stopped;
  console.result(fmt::format("{}\nresults: {}\nnext: {}", result_text(options.task, *result), output.native(),
                             compare_line(options.program, options.file, output)));
  return code_of(result->outcome);
}

ExitCode execute(const SystemsOptions& options, Console& console) {
  const StopSignal signal;
  const StoredTask stored = stored_task(options.file, options.task, 0);
  const fs::path output = output_of(options, "systems", console);
  SystemsFile systems;
  const auto nothing = [](const Task&, const TaskRecord&, const TaskOrigin*) {};
  TaskHooks hooks;
  hooks.observe = [&](const Rod& rod, const LinearSystem& system, const SolvePosition& at, const VectorX& solution) {
    if (at.step % options.every == 0 && (at.newton == 0 || !options.first)) systems.add(rod, system, at, solution);
  };
  const auto result = run_task_here(TaskRunner(stored.single, nothing, hooks), signal, console);
  if (!result) return ExitCode::stopped;
  if (systems.count() == 0)
    throw FileError("task {} of {} solves no linear system{}", options.task, options.file.native(),
                    result->message.empty() ? "" : ": " + result->message);
  const Provenance made = provenance_of_this_process(options.command);
  systems.write(output,
                {{"program", "rodsweep"},
                 {"kind", "systems"},
                 {"title", fmt::format("rodsweep systems: task {} of {}", options.task, stored.whole.job().name)},
                 {"job", stored.whole.job().text},
                 {"command", made.user_command},
                 {"revision", made.revision},
                 {"versions", made.versions}});
  console.result(
      fmt::format("{}\n{} systems: {}", result_text(options.task, *result), systems.count(), output.native()));
  return code_of(result->outcome);
}

}  // namespace rodsweep
