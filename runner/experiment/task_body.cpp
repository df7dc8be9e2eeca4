#include "runner/experiment/task_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <map>
#include <new>
#include <stdexcept>
#include <utility>

#include "runner/experiment/batched_evaluation.hpp"
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

/// If the task throws, its record keeps only the error message.
bool evaluate_alone(const TaskRun& run, const AxisSizes& sizes, const Evaluate& evaluate, const StopRequested& stop) {
  try {
    return evaluate(run.task, run.spec, *run.record, stop);
  } catch (const std::bad_alloc&) {
    run.record->message = out_of_memory_text();
  } catch (const std::exception& error) {
    run.record->message = error.what();
  }
  const std::string message = std::move(run.record->message);
  run.record->prepare(run.task, sizes);
  run.record->outcome = TaskOutcome::error;
  run.record->message = message;
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

std::vector<std::int64_t> batches(const Plan& plan) {
  if (plan.rows(Rows::system) == 0) return std::vector<std::int64_t>(static_cast<std::size_t>(plan.size()), -1);
  std::map<BatchKey, std::int64_t> numbers;
  std::vector<std::int64_t> out;
  for (const Task& task : plan.tasks()) {
    const TaskSpec spec = plan.spec(task.index);
    const auto next = static_cast<std::int64_t>(numbers.size());
    out.push_back(steps_in_batches(spec) ? numbers.try_emplace(batch_key(spec), next).first->second : -1);
  }
  return out;
}

BatchBody task_body(const Plan& plan, WriteRecord write, Evaluate evaluate) {
  return [&plan, write = std::move(write), evaluate = std::move(evaluate), sizes = axis_sizes(plan),
          records = std::vector<TaskRecord>()](const std::vector<std::int64_t>& tasks,
                                               const StopRequested& stop) mutable -> std::vector<TaskResult> {
    records.resize(std::max(records.size(), tasks.size()));  // their memory is reused
    std::vector<TaskRun> runs;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      const Task task = plan.task(tasks[i]);
      try {
        if (!unless_stopped(stop, [&] { records[i].prepare(task, sizes); }))
          return std::vector<TaskResult>(tasks.size());
      } catch (const std::bad_alloc&) {
        throw std::runtime_error(fmt::format("the results of task {} do not fit: {}", task.index,
                                             out_of_memory_text() + ", or record less (\"record\" in the job)"));
      }
      runs.push_back({task, plan.spec(tasks[i]), &records[i]});
    }
    std::vector<TaskResult> results(tasks.size());
    if (runs.size() == 1 ? !evaluate_alone(runs.front(), sizes, evaluate, stop) : !evaluate_batch(runs, stop)) {
      for (std::size_t i = 0; i < tasks.size(); ++i)
        results[i].share = records[i].tasks.steps_done[0] / static_cast<double>(runs[i].task.steps);
      return results;
    }
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      if (unless_stopped(stop, [&] { write(runs[i].task, records[i], nullptr); }))
        results[i] = {records[i].outcome, records[i].message};
    }
    return results;
  };
}

BatchBody extending_body(const Plan& plan, const Extension& extension, WriteRecord write,
                         std::function<void(const std::string&)> warn, Evaluate evaluate) {
  return one_by_one([&plan, &extension, write, warn = std::move(warn), evaluate, run = task_body(plan, write, evaluate),
                     sizes = axis_sizes(plan), taken = TaskRecord(),
                     record = TaskRecord()](std::int64_t index, const StopRequested& stop) mutable -> TaskResult {
    const Task task = plan.task(index);
    const Extension::Use use = extension.use(index);
    if (use == Extension::Use::run) return run({index}, stop).front();
    taken.prepare(task, sizes);
    if (!extension.take(index, taken)) {
      warn(fmt::format("task {} of {} is damaged (wrong checksum); it is run again as task {}", extension.source(index),
                       extension.path().native(), index));
      return run({index}, stop).front();
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
  });
}

}  // namespace rodsweep
