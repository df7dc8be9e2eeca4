#include "runner/command/rerun_command.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include "runner/command/next_command.hpp"
#include "runner/command/stored_task.hpp"
#include "runner/dispatch/stop_signal.hpp"
#include "runner/file/results_file.hpp"
#include "runner/file/unfinished_file.hpp"
#include "runner/measure/task_runner.hpp"

namespace rodsweep {

namespace fs = std::filesystem;

ExitCode execute(const RerunOptions& options, Console& console) {
  const StopSignal signal;
  const StoredTask stored = stored_task(options.file, options.task, options.trajectory_every);
  const Plan& plan = stored.alone;
  const fs::path output = options.output.value_or(file_beside(options.file, fmt::format("-task-{}", options.task)));
  refuse_existing(output);
  if (const std::string left = unfinished_text(output); !left.empty()) console.warn(left);
  Provenance provenance = provenance_of_this_process(options.command);
  provenance.job = plan.job().path.native();

  const Task task = plan.task(0);
  console.note(
      fmt::format("task {}: {} segments, {} steps, {} frames", options.task, task.segments, task.steps, task.frames));
  TaskRunner run(plan, [&](const Task& done, const TaskRecord& record, const TaskOrigin*) {
    ResultsFile file = ResultsFile::create(output, plan, provenance, MPI_COMM_SELF);
    file.write(done, record);
    const ExitCode code = record.outcome == TaskOutcome::ok ? ExitCode::ok : ExitCode::tasks_failed;
    file.end_run(utc_now(), static_cast<int>(code));
    file.close();
    file.check_written();
  });
  const TaskResult result = run(0, [&] { return signal.received() != 0; });
  if (result.outcome == TaskOutcome::pending) {
    console.note(fmt::format("stopped early by {}; nothing was written", signal_cause(signal.received())));
    return ExitCode::stopped;
  }
  console.result(fmt::format("task {}: {}{}\nresults: {}\nnext: {}", options.task, to_string(result.outcome),
                             result.message.empty() ? "" : ": " + result.message, output.native(),
                             compare_line(options.program, options.file, output)));
  return result.outcome == TaskOutcome::ok ? ExitCode::ok : ExitCode::tasks_failed;
}

}  // namespace rodsweep
