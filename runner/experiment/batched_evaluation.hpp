// Simulations of a data set, one in each lane of a register at once (solver/batch/batched_step.hpp).
//
// A task's record is the same to the bit in every batch, also alone in one: what is simulated together is a matter of
// speed only. Systems have no times of their own; a step's and a task's are its share of the batch's.
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

/// Is this a simulation of a data set that the batched step knows: an inextensible chain without loads or wind?
bool steps_in_batches(const TaskSpec& spec);

/// Such tasks fit together whose keys are equal: equal chains, and as many steps of the same kind.
using BatchKey = std::tuple<int, Clamp, double, int, int, double, double>;
BatchKey batch_key(const TaskSpec& spec);

/// evaluate() of all of them, one or more that fit together. False: abandoned on request, and so are all records.
bool evaluate_batch(const std::vector<TaskRun>& runs, const StopRequested& stop);

/// evaluate() with the time that the task takes in a full batch, where it would be in one: what a plan estimates from.
bool evaluate_among_equals(const Task& task, const TaskSpec& spec, TaskRecord& record, const StopRequested& stop);

}  // namespace rodsweep
