// Simulates a batch of data set tasks at once, one task per SIMD lane (solver/batch/batched_step.hpp).
//
// A task's record is bitwise the same in every batch, also alone in one: batching only affects speed.
// Systems are not timed; the time of a step or task is its share of the batch's time.
#pragma once

#include <tuple>
#include <vector>

#include "runner/experiment/evaluation.hpp"

namespace rodsweep {

/// A task to evaluate, with its prepared record.
struct TaskRun {
  Task task;
  TaskSpec spec;
  TaskRecord* record = nullptr;
};

/// Whether the batched step supports this task: a data set task of a chain without tip force, wind or contact.
bool steps_in_batches(const TaskSpec& spec);

/// Tasks with equal keys may share a batch: their segments, clamp, steps and Newton settings agree.
using BatchKey = std::tuple<int, Clamp, double, Integrator, int, int, double, double>;
BatchKey batch_key(const TaskSpec& spec);

/// Evaluates one or more tasks with equal keys. Returns false if abandoned on request; then discard all records.
bool evaluate_batch(const std::vector<TaskRun>& runs, const StopRequested& stop);

/// evaluate() with the time per task of a full batch if the task supports batches. Used for estimates of a plan.
bool evaluate_among_equals(const Task& task, const TaskSpec& spec, TaskRecord& record, const StopRequested& stop);

}  // namespace rodsweep
