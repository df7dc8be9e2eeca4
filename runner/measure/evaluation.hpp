// Runs one task: simulates its rods, counts CG iterations for every guess, measures times, and fills the record.
// Everything outside /timing depends only on the spec.
#pragma once

#include <functional>

#include "runner/dispatch/stop_requested.hpp"
#include "runner/file/record.hpp"
#include "runner/plan/task.hpp"
#include "runner/specs/task_spec.hpp"
#include "solver/step/projection.hpp"
#include "solver/step/stopwatch.hpp"

namespace rodsweep {

/// Fills `record` (already prepared). Returns false if abandoned on request. The record of a failed task has the
/// failure's outcome and the rows up to it; exceptions of the scene or the solver become TaskOutcome::error.
bool evaluate(const Task& task, const TaskSpec& spec, TaskRecord& record, const StopRequested& stop);

/// Sees every system that is solved: the rod as the system was assembled, and the solution that moves it next.
using ObserveSystem =
    std::function<void(const Rod&, const LinearSystem&, const SolvePosition&, const VectorX& solution)>;

/// The same task, seen system by system.
bool evaluate_observed(const ObserveSystem& observe, const Task& task, const TaskSpec& spec, TaskRecord& record,
                       const StopRequested& stop);

/// The same, with the clock for the task's time limit.
bool evaluate_by_clock(TimeSource now, const Task& task, const TaskSpec& spec, TaskRecord& record,
                       const StopRequested& stop);

}  // namespace rodsweep
