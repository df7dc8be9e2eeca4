// Runs one task: simulates its rods, counts CG iterations for every guess, measures times, and fills the record.
// Everything outside /timing depends only on the spec.
#pragma once

#include <chrono>
#include <functional>

#include "runner/dispatch/worker.hpp"
#include "runner/file/record.hpp"
#include "runner/plan/task.hpp"
#include "runner/specs/task_spec.hpp"
#include "solver/step/projection.hpp"

namespace rodsweep {

/// Sees every system that is solved: the rod as the system was assembled, and the solution that moves it next.
using ObserveSystem =
    std::function<void(const Rod&, const LinearSystem&, const SolvePosition&, const VectorX& solution)>;

struct TaskHooks {
  TimeSource clock = std::chrono::steady_clock::now;  ///< for the task's time limit
  StopRequested stop = [] { return false; };
  ObserveSystem observe{};
};

/// Fills `record` (already prepared). Returns false if abandoned on request. The record of a failed task has the
/// failure's outcome and the rows up to it; exceptions of the scene or the solver become TaskOutcome::error.
bool run_task(const Task& task, const TaskSpec& spec, TaskRecord& record, const TaskHooks& hooks = {});

}  // namespace rodsweep
