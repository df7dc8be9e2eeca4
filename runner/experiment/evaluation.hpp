// Runs one task: simulates its rods, counts CG iterations for every guess, times the parts, and returns the record.
// Physics, iteration counts and everything outside /timing depend on the spec alone.
#pragma once

#include "runner/dispatch/stop_requested.hpp"
#include "runner/file/record.hpp"
#include "runner/job/task.hpp"
#include "solver/step/stopwatch.hpp"

namespace rodsweep {

/// Fills `record` (already prepared). Returns false if it was abandoned on request. A task that fails is a record with
/// that outcome and whatever rows it reached; exceptions of the scene or the solver become TaskOutcome::error.
bool evaluate(const Task& task, const TaskSpec& spec, TaskRecord& record, const StopRequested& stop);

/// The same with the clock that its time limit is of.
bool evaluate_by_clock(TimeSource now, const Task& task, const TaskSpec& spec, TaskRecord& record,
                       const StopRequested& stop);

}  // namespace rodsweep
