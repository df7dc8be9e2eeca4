#include "runner/experiment/extending_body.hpp"

#include <fmt/format.h>

#include <utility>

#include "runner/experiment/measured_solve.hpp"

namespace rodsweep {
namespace {

/// The guesses that the earlier file lacks, on the task's trajectory, put beside those that it has. False: abandoned.
bool complete_task(const Plan& plan, const Extension& extension, const Evaluate& evaluate, const StopRequested& stop,
                   const Task& task, const TaskRecord& taken, TaskRecord& record) {
  TaskSpec spec = plan.spec(task.index);
  for (const std::int8_t copied : taken.copied_guess) spec.settled.push_back(copied == 1);
  if (!evaluate(task, spec, record, stop)) return false;
  // Not the trajectory's doing: an outcome like any other.
  if (record.outcome == TaskOutcome::timed_out || record.outcome == TaskOutcome::error) return true;
  const std::string difference = complete(task, record, taken);
  if (!difference.empty()) {
    const std::string earlier = extension.path().native();
    throw FileError(fmt::format(
        "task {}, simulated again for its new guesses, is not what {} holds as task {}: {}. That file is of "
        "another machine or revision, and its guesses cannot stand beside new ones; --resume without "
        "--extend runs what is left in full",
        task.index, earlier, extension.source(task.index), difference));
  }
  set_cg_ratios(spec, record);
  return true;
}

}  // namespace

TaskBody extending_body(const Plan& plan, const Extension& extension, Evaluate evaluate, WriteExtended write,
                        std::function<void(const std::string&)> warn) {
  TaskBody run = task_body(plan, evaluate, [write](const Task& task, const TaskRecord& r) { write(task, r, nullptr); });
  return [&plan, &extension, evaluate = std::move(evaluate), write = std::move(write), warn = std::move(warn),
          run = std::move(run), sizes = axis_sizes(plan), taken = TaskRecord(),
          record = TaskRecord()](std::int64_t index, const StopRequested& stop) mutable -> TaskResult {
    const Task& task = plan.task(index);
    const Extension::Use use = extension.use(index);
    if (use == Extension::Use::run) return run(index, stop);
    taken.prepare(task, sizes);
    if (!extension.take(index, taken)) {
      warn(fmt::format(
          "task {} of {} is damaged: its data are not what was written (checksum); it is run again as task {}",
          extension.source(index), extension.path().native(), index));
      return run(index, stop);
    }
    if (use == Extension::Use::copy) {
      const TaskOrigin origin = extension.origin(index);
      write(task, taken, &origin);
      return {taken.outcome, taken.message};
    }
    record.prepare(task, sizes);
    if (!complete_task(plan, extension, evaluate, stop, task, taken, record)) return {};
    write(task, record, nullptr);
    return {record.outcome, record.message};
  };
}

}  // namespace rodsweep
