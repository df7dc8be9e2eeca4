// How a linear solve, a step or a task ended. Non-convergence is data: these values travel to the user's file.
#pragma once

#include <cstdint>

namespace rodsweep {

/// Outcome of one linear solve. The numbers are stored in files (/solves/reason); never renumber.
enum class SolveOutcome : std::int8_t {
  not_run = 0,          ///< the row was never solved (Newton had converged, or the task ended early)
  converged = 1,        ///< the tolerance was met
  zero_rhs = 2,         ///< b is zero to rounding: nothing to solve, zero iterations
  iteration_limit = 3,  ///< the cap on iterations was reached first
  diverged = 4,         ///< the residual grew past the divergence limit
  indefinite = 5,       ///< the matrix or the preconditioner is not positive definite
  not_a_number = 6,     ///< a NaN or infinity appeared
};

/// Outcome of a whole task. Stored in files (/tasks/outcome) by name.
enum class TaskOutcome : std::int8_t {
  pending = 0,          ///< not run yet
  ok = 1,               ///< every step was taken
  diverged = 2,         ///< the simulation blew up (joint gap beyond any meaning) or a solve diverged
  not_a_number = 3,     ///< the state holds a NaN or infinity
  indefinite = 4,       ///< the system matrix lost positive definiteness
  iteration_limit = 5,  ///< the solve that advances the trajectory hit its cap on iterations
  timed_out = 6,        ///< the task's time limit passed
  error = 7,            ///< an exception; its text is the task's message
};

const char* to_string(SolveOutcome outcome);
const char* to_string(TaskOutcome outcome);

}  // namespace rodsweep
