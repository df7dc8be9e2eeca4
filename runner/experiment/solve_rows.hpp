// What every method says of a linear system before it is solved: the columns of /solves that belong to no guess.
#pragma once

#include "runner/file/record.hpp"
#include "runner/job/task.hpp"
#include "solver/linear/linear_system.hpp"
#include "solver/step/projection.hpp"

namespace rodsweep {

/// The row of a solve among its task's, of a scene of so many rods: step-major, then Newton iterations, then rods.
std::size_t solve_row(const TaskSpec& spec, std::size_t rods, const SolvePosition& at);

/// Where in its simulation a row stands.
void log_position(const SolvePosition& at, std::size_t row, TaskRecord& record);

/// Position, residuals and gap: `rod` in the state that the system was assembled from.
void log_system(const LinearSystem& system, const Rod& rod, const SolvePosition& at, std::size_t row,
                TaskRecord& record);

}  // namespace rodsweep
