// What a worker does with one task: evaluate it, write its record. Whatever goes wrong while evaluating is an outcome
// of the task and is written like any other; only a failing write is an exception.
#pragma once

#include <functional>

#include "runner/dispatch/worker.hpp"
#include "runner/experiment/evaluation.hpp"
#include "runner/job/plan.hpp"

namespace rodsweep {

using Evaluate = std::function<bool(const Task&, const TaskSpec&, TaskRecord&, const StopRequested&)>;
using WriteRecord = std::function<void(const Task&, const TaskRecord&)>;

/// The plan must outlive the body.
TaskBody task_body(const Plan& plan, Evaluate evaluate, WriteRecord write);

}  // namespace rodsweep
