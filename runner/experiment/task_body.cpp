#include "runner/experiment/task_body.hpp"

#include <fmt/format.h>

#include <exception>
#include <new>
#include <stdexcept>
#include <utility>

#include "runner/experiment/host_memory.hpp"
#include "runner/experiment/measured_solve.hpp"
#include "runner/file/extension.hpp"
#include "solver/linear/interruption.hpp"

namespace rodsweep {
namespace {

/// Returns whether `part` came to its end before `stop` returned true.
template <class Part>
bool unless_stopped(const StopRequested& stop, Part&& part) {
  const Interruptible interruptible([&] { return stop && stop(); });
  try {
    part();
    return true;
  } catch (const InterruptedComputation&) {
    return false;
  }
}

/// If the task throws, its record keeps only the error message. False if abandoned.
bool evaluate_caught(const Task& task, const TaskSpec& spec, const AxisSizes& sizes, const Evaluate& evaluate,
                     const StopRequested& stop, TaskRecord& record) {
  std::string message;
  try {
    return evaluate(task, spec, record, stop);
  } catch (const std::bad_alloc&) {
    message = out_of_memory_text();
  } catch (const std::exception& error) {
    message = error.what();
  }
  record.prepare(task, sizes);
  record.outcome = TaskOutcome::error;
  record.message = message;
  return true;
}

/// Evaluates the guesses missing in the earlier file, and merges the others into the record. False if abandoned.
bool complete_task(const Plan& plan, const Extension& extension, const Evaluate& evaluate, const StopRequested& stop,
                   const Task& task, const TaskRecord& taken, TaskRecord& record) {
  TaskSpec spec = plan.spec(task.index);
  for (const std::int8_t copied : taken.timing.copied_guess) spec.settled.push_back(copied == 1);
  if (!evaluate(task, spec, record, stop)) return false;
  // These outcomes do not mean that the trajectory differs.
  if (record.outcome == TaskOutcome::timed_out || record.outcome == TaskOutcome::error) return true;
  const std::string difference = complete(task, record, taken);
  if (!difference.empty()) {
    const std::string earlier = extension.path().native();
    throw FileError(
        fmt::format("task {}, repeated for its new guesses, differs from {}, task {}: {}. That file is from another "
                    "machine or revision, and its results cannot be combined with new ones; use --resume without "
                    "--extend to run the remaining tasks in full",
                    task.index, earlier, extension.source(task.index), difference));
  }
  set_cg_ratios(spec, record);
  return true;
}

}  // namespace

TaskBody task_body(const Plan& plan, WriteRecord write, Evaluate evaluate) {
  return [&plan, write = std::move(write), evaluate = std::move(evaluate), sizes = axis_sizes(plan),
          record = TaskRecord()](std::int64_t index, const StopRequested& stop) mutable -> TaskResult {
    const Task task = plan.task(index);
    try {
      if (!unless_stopped(stop, [&] { record.prepare(task, sizes); })) return {};
    } catch (const std::bad_alloc&) {
      throw std::runtime_error(fmt::format("the results of task {} do not fit: {}", index,
                                           out_of_memory_text() + ", or record less (\"record\" in the job)"));
    }
    if (!evaluate_caught(task, plan.spec(index), sizes, evaluate, stop, record)) return {};
    if (!unless_stopped(stop, [&] { write(task, record, nullptr); })) return {};
    return {record.outcome, record.message};
  };
}

TaskBody extending_body(const Plan& plan, const Extension& extension, WriteRecord write,
                        std::function<void(const std::string&)> warn, Evaluate evaluate) {
  return [&plan, &extension, write, warn = std::move(warn), evaluate, run = task_body(plan, write, evaluate),
          sizes = axis_sizes(plan), taken = TaskRecord(),
          record = TaskRecord()](std::int64_t index, const StopRequested& stop) mutable -> TaskResult {
    const Task task = plan.task(index);
    const Extension::Use use = extension.use(index);
    if (use == Extension::Use::run) return run(index, stop);
    taken.prepare(task, sizes);
    if (!extension.take(index, taken)) {
      warn(fmt::format("task {} of {} is damaged (wrong checksum); it is run again as task {}", extension.source(index),
                       extension.path().native(), index));
      return run(index, stop);
    }
    if (use == Extension::Use::copy) {
      const TaskOrigin origin = extension.origin(index);
      if (!unless_stopped(stop, [&] { write(task, taken, &origin); })) return {};
      return {taken.outcome, taken.message};
    }
    record.prepare(task, sizes);
    if (!complete_task(plan, extension, evaluate, stop, task, taken, record)) return {};
    if (!unless_stopped(stop, [&] { write(task, record, nullptr); })) return {};
    return {record.outcome, record.message};
  };
}

}  // namespace rodsweep
