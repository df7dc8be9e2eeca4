#include "runner/command/rerun_command.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include "runner/command/stored_task.hpp"
#include "runner/dispatch/stop_signal.hpp"
#include "runner/experiment/task_body.hpp"
#include "runner/file/file_reading.hpp"
#include "runner/file/results_file.hpp"
#include "runner/file/task_comparison.hpp"
#include "runner/file/unfinished_file.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

ExitCode compare(const RerunOptions& options, const fs::path& output, const Plan& whole, Console& console) {
  const std::int64_t every = whole.job().values["record"]["trajectory_every"];
  const TaskComparison found = compare_task(options.file, options.task, every, output, options.trajectory_every);
  if (found.differing.empty()) {
    console.result(fmt::format("identical to task {} of {}, in all {} datasets outside /timing", options.task,
                               options.file.native(), found.compared));
    return ExitCode::ok;
  }
  console.result(fmt::format("{} of {} datasets differ from task {} of {}:\n  {}", found.differing.size(),
                             found.compared, options.task, options.file.native(), fmt::join(found.differing, "\n  ")));
  return ExitCode::differ;
}

}  // namespace

ExitCode execute(const RerunOptions& options, Console& console) {
  const StopSignal signal;
  const StoredTask stored = stored_task(options.file, options.task, options.trajectory_every);
  const Plan& whole = stored.whole;
  const Plan& plan = stored.alone;
  const fs::path output = options.output.value_or(file_beside(options.file, fmt::format("-task-{}", options.task)));
  refuse_existing(output);
  if (const std::string left = unfinished_text(output); !left.empty()) console.warn(left);
  Provenance provenance = provenance_of_this_process(options.command);
  provenance.job = whole.job().path.native();

  const Task task = plan.task(0);
  console.note(
      fmt::format("task {}: {} segments, {} steps, {} frames", options.task, task.segments, task.steps, task.frames));
  const TaskBody body = task_body(plan, [&](const Task& done, const TaskRecord& record, const TaskOrigin*) {
    ResultsFile file = ResultsFile::create(output, plan, provenance, MPI_COMM_SELF);
    file.write(done, record);
    const ExitCode code = record.outcome == TaskOutcome::ok ? ExitCode::ok : ExitCode::tasks_failed;
    file.end_run(utc_now(), static_cast<int>(code));
    file.close();
    file.check_written();
  });
  const TaskResult result = body(0, [&] { return signal.received() != 0; });
  if (result.outcome == TaskOutcome::pending) {
    console.note(fmt::format("stopped early by {}; nothing was written", signal_cause(signal.received())));
    return ExitCode::stopped;
  }
  console.result(fmt::format("task {}: {}{}\nresults: {}", options.task, to_string(result.outcome),
                             result.message.empty() ? "" : ": " + result.message, output.native()));
  const hdf5::File file = open_results(options.file);
  const auto index = static_cast<std::size_t>(options.task);
  std::string outcome = to_string(TaskOutcome::pending);
  if (read_states(file, options.file).at(index) == 1) outcome = hdf5::read_texts(file.id(), "/tasks/outcome").at(index);
  if (!may_change(outcome_called(outcome).value_or(TaskOutcome::ok))) return compare(options, output, whole, console);
  console.result(
      fmt::format("task {} is {} in {}: nothing to compare with", options.task, outcome, options.file.native()));
  return result.outcome == TaskOutcome::ok ? ExitCode::ok : ExitCode::tasks_failed;
}

}  // namespace rodsweep
