// Evaluates the tasks of an assignment, together if they share a batch, and writes their records. In a sweep that
// extends an earlier file (runner/file/extension.hpp), a task is copied, completed or run.
// A failed evaluation is an outcome, which is written like any other. Throws only if a record can't be allocated or
// written, or does not match the earlier file.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "runner/dispatch/worker.hpp"
#include "runner/experiment/evaluation.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

class Extension;
struct TaskOrigin;

using Evaluate = std::function<bool(const Task&, const TaskSpec&, TaskRecord&, const StopRequested&)>;
/// `origin`: who ran the task, if it is copied from another file; else nullptr.
using WriteRecord = std::function<void(const Task&, const TaskRecord&, const TaskOrigin* origin)>;

/// The batch number of each task: tasks with equal numbers may share a batch (batched_evaluation.hpp).
/// -1: evaluated alone.
std::vector<std::int64_t> batches(const Plan& plan);

/// `evaluate` is used for assignments of a single task. The plan must outlive the body.
BatchBody task_body(const Plan& plan, WriteRecord write, Evaluate evaluate = rodsweep::evaluate);

/// If a source task is damaged, calls `warn` and runs the task. Throws FileError with the task if a repeated trajectory
/// is not bitwise equal to the stored one. Plan and extension must outlive the body.
BatchBody extending_body(const Plan& plan, const Extension& extension, WriteRecord write,
                         std::function<void(const std::string&)> warn, Evaluate evaluate = rodsweep::evaluate);

}  // namespace rodsweep
