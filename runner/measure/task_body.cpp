#include "runner/measure/task_body.hpp"

#include <fmt/format.h>

#include <exception>
#include <new>
#include <stdexcept>
#include <utility>

#include "runner/file/extension.hpp"
#include "runner/measure/host_memory.hpp"
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
                        std::function<void(const std::string&)> warn) {
  return [&plan, &extension, write, warn = std::move(warn), run = task_body(plan, write), sizes = axis_sizes(plan),
          record = TaskRecord()](std::int64_t index, const StopRequested& stop) mutable -> TaskResult {
    if (extension.source(index) < 0) return run(index, stop);
    const Task task = plan.task(index);
    record.prepare(task, sizes);
    if (!extension.take(index, record)) {
      warn(fmt::format("task {} of {} is damaged (wrong checksum); it is run again as task {}", extension.source(index),
                       extension.path().native(), index));
      return run(index, stop);
    }
    const TaskOrigin origin = extension.origin(index);
    if (!unless_stopped(stop, [&] { write(task, record, &origin); })) return {};
    return {record.outcome, record.message};
  };
}

}  // namespace rodsweep
