// What a worker does with the tasks of an assignment: evaluate them, together if they are of one batch, and write their
// records; in a sweep that extends an earlier file (runner/file/extension.hpp) copy a task, complete it, or run it like
// any other. Whatever goes wrong while evaluating is an outcome of the task and is written like any other; only a
// failing write is an exception.
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
/// `origin`: who ran the task, where it was copied whole; else nullptr.
using WriteRecord = std::function<void(const Task&, const TaskRecord&, const TaskOrigin* origin)>;

/// For every task of the plan the number of its batch: tasks that share one fit together (batched_evaluation.hpp).
/// -1: evaluated alone.
std::vector<std::int64_t> batches(const Plan& plan);

/// `evaluate` is for assignments of one task. The plan must outlive the body.
BatchBody task_body(const Plan& plan, WriteRecord write, Evaluate evaluate = rodsweep::evaluate);

/// A source that is damaged is reported to `warn`, and its task run. A trajectory that is not, to the last bit, what it
/// was is a FileError naming the task. Plan and extension must outlive the body.
BatchBody extending_body(const Plan& plan, const Extension& extension, WriteRecord write,
                         std::function<void(const std::string&)> warn, Evaluate evaluate = rodsweep::evaluate);

}  // namespace rodsweep
