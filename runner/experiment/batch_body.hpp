// What a worker does with the tasks of an assignment: evaluate them, together if they are of one batch, and write their
// records.
#pragma once

#include <vector>

#include "runner/dispatch/worker.hpp"
#include "runner/experiment/task_body.hpp"
#include "runner/job/plan.hpp"

namespace rodsweep {

/// For every task of the plan the number of its batch: tasks that share one fit together (batched_evaluation.hpp).
/// -1: evaluated alone.
std::vector<std::int64_t> batches(const Plan& plan);

/// The plan must outlive the body.
BatchBody batch_body(const Plan& plan, WriteRecord write);

}  // namespace rodsweep
