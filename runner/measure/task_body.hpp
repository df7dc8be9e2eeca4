// Evaluates a task and writes its record. In a sweep that extends an earlier file (runner/file/extension.hpp), a task
// is copied or run.
// A failed evaluation is an outcome, which is written like any other. Throws only if a record can't be allocated or
// written.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "runner/dispatch/worker.hpp"
#include "runner/measure/evaluation.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

class Extension;
struct TaskOrigin;

using Evaluate = std::function<bool(const Task&, const TaskSpec&, TaskRecord&, const StopRequested&)>;
/// `origin`: who ran the task, if it is copied from another file; else nullptr.
using WriteRecord = std::function<void(const Task&, const TaskRecord&, const TaskOrigin* origin)>;

/// The plan must outlive the body.
TaskBody task_body(const Plan& plan, WriteRecord write, Evaluate evaluate = rodsweep::evaluate);

/// If a source task is damaged, calls `warn` and runs the task. Plan and extension must outlive the body.
TaskBody extending_body(const Plan& plan, const Extension& extension, WriteRecord write,
                        std::function<void(const std::string&)> warn);

}  // namespace rodsweep
