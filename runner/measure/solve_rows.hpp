// The columns of /solves that do not depend on the guess; they describe a linear system before its solve.
#pragma once

#include "runner/file/record.hpp"
#include "runner/specs/task_spec.hpp"
#include "solver/linear/linear_system.hpp"
#include "solver/step/projection.hpp"

namespace rodsweep {

/// The row of a solve within its task: ordered by step, Newton iteration, rod. `rods`: number of rods in the scene.
std::size_t solve_row(const TaskSpec& spec, std::size_t rods, const SolvePosition& at);

/// Writes step, Newton iteration and rod.
void log_position(const SolvePosition& at, std::size_t row, TaskRecord& record);

/// Writes position, residual, gap and norm. `rod` is in the state from which the system was assembled.
void log_system(const LinearSystem& system, const Rod& rod, const SolvePosition& at, std::size_t row,
                TaskRecord& record);

}  // namespace rodsweep
