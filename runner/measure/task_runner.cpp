#include "runner/measure/task_runner.hpp"

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
  const Interruptible interruptible(stop);
  try {
    part();
    return true;
  } catch (const InterruptedComputation&) {
    return false;
  }
}

}  // namespace

TaskRunner::TaskRunner(const Plan& plan, Write write, TaskHooks hooks)
    : plan_(&plan), sizes_(axis_sizes(plan)), write_(std::move(write)), hooks_(std::move(hooks)) {}

void TaskRunner::copy_from(const Extension& extension, std::function<void(const std::string&)> warn) {
  extension_ = &extension;
  warn_ = std::move(warn);
}

TaskResult TaskRunner::operator()(std::int64_t index, const StopRequested& stop) {
  std::exception_ptr failure;  // of stop(), such as a sync or a message: not the task's outcome
  const StopRequested checked_stop = [&] {
    try {
      return stop();
    } catch (...) {
      failure = std::current_exception();
      return true;
    }
  };
  TaskResult result = run(index, checked_stop);
  if (failure) std::rethrow_exception(failure);
  return result;
}

TaskResult TaskRunner::run(std::int64_t index, const StopRequested& stop) {
  const Task task = plan_->task(index);
  if (!unless_stopped(stop, [&] { prepare(task); })) return {};
  const bool copied = copy(task);
  if (!copied && !run_task(task, plan_->spec(index), record_, {hooks_.clock, stop, hooks_.observe})) return {};
  const TaskOrigin origin = copied ? extension_->origin(index) : TaskOrigin();
  if (!unless_stopped(stop, [&] { write_(task, record_, copied ? &origin : nullptr); })) return {};
  return {record_.outcome, record_.message};
}

void TaskRunner::prepare(const Task& task) try { record_.prepare(task, sizes_); } catch (const std::bad_alloc&) {
  throw std::runtime_error(fmt::format("the results of task {} do not fit: {}, or record less (\"record\" in the job)",
                                       task.index, out_of_memory_text()));
}

/// Whether the record now holds the task's results of the earlier file.
bool TaskRunner::copy(const Task& task) {
  if (extension_ == nullptr || extension_->source(task.index) < 0) return false;
  if (extension_->take(task.index, record_)) return true;
  warn_(fmt::format("task {} of {} is damaged (wrong checksum); it is run again as task {}",
                    extension_->source(task.index), extension_->path().native(), task.index));
  return false;
}

}  // namespace rodsweep
