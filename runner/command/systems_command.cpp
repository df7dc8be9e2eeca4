#include "runner/command/systems_command.hpp"

#include <fmt/format.h>

#include "runner/command/stored_task.hpp"
#include "runner/dispatch/stop_signal.hpp"
#include "runner/file/provenance.hpp"
#include "runner/file/systems_file.hpp"
#include "runner/file/unfinished_file.hpp"
#include "runner/measure/task_runner.hpp"

namespace rodsweep {

namespace fs = std::filesystem;

ExitCode execute(const SystemsOptions& options, Console& console) {
  const StopSignal signal;
  const StoredTask stored = stored_task(options.file, options.task, 0);
  const fs::path output = options.output.value_or(file_beside(options.file, fmt::format("-systems-{}", options.task)));
  refuse_existing(output);
  if (const std::string left = unfinished_text(output); !left.empty()) console.warn(left);

  SystemsFile systems;
  const auto nothing = [](const Task&, const TaskRecord&, const TaskOrigin*) {};
  TaskHooks hooks;
  hooks.observe = [&](const Rod& rod, const LinearSystem& system, const SolvePosition& at, const VectorX& solution) {
    if (at.step % options.every == 0 && (at.newton == 0 || !options.first)) systems.add(rod, system, at, solution);
  };
  TaskRunner run(stored.alone, nothing, hooks);
  const TaskResult result = run(0, [&] { return signal.received() != 0; });
  if (result.outcome == TaskOutcome::pending) {
    console.note(fmt::format("stopped early by {}; nothing was written", signal_cause(signal.received())));
    return ExitCode::stopped;
  }
  if (systems.count() == 0)
    throw FileError(fmt::format("task {} of {} solves no linear system{}", options.task, options.file.native(),
                                result.message.empty() ? "" : ": " + result.message));
  const Provenance made = provenance_of_this_process(options.command);
  systems.write(output,
                {{"program", "rodsweep"},
                 {"kind", "systems"},
                 {"title", fmt::format("rodsweep systems: task {} of {}", options.task, stored.whole.job().name)},
                 {"job", stored.whole.job().text},
                 {"command", made.user_command},
                 {"revision", made.revision},
                 {"versions", made.versions}});
  console.result(fmt::format("task {}: {}{}\n{} systems: {}", options.task, to_string(result.outcome),
                             result.message.empty() ? "" : ": " + result.message, systems.count(), output.native()));
  return result.outcome == TaskOutcome::ok ? ExitCode::ok : ExitCode::tasks_failed;
}

}  // namespace rodsweep
