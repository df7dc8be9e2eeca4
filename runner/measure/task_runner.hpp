// Runs the tasks of a plan and writes their records: the body of a worker. In a sweep that extends an earlier file
// (runner/file/extension.hpp), a task that the file has is copied.
// A failed task is an outcome, which is written like any other. Throws only if a record can't be allocated or written, or
// if `stop` throws.
#pragma once

#include <functional>
#include <string>

#include "runner/measure/run_task.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

class Extension;
struct TaskOrigin;

class TaskRunner {
 public:
  /// `origin`: who ran the task, if it is copied from another file; else nullptr.
  using Write = std::function<void(const Task&, const TaskRecord&, const TaskOrigin* origin)>;

  /// The plan must outlive this. `hooks.stop` is not used: a call has its own.
  TaskRunner(const Plan& plan, Write write, TaskHooks hooks = {});

  /// Copies tasks from `extension`, which must outlive this. If a task of it is damaged, calls `warn` and runs the task.
  void copy_from(const Extension& extension, std::function<void(const std::string&)> warn);

  TaskResult operator()(std::int64_t index, const StopRequested& stop);

 private:
  TaskResult run(std::int64_t index, const StopRequested& stop);
  void prepare(const Task& task);
  bool copy(const Task& task);

  const Plan* plan_;
  AxisSizes sizes_;
  Write write_;
  TaskHooks hooks_;
  const Extension* extension_ = nullptr;
  std::function<void(const std::string&)> warn_;
  TaskRecord record_;
};

}  // namespace rodsweep
