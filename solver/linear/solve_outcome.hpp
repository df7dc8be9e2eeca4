// How a linear solve ended. Non-convergence is data: these values are stored in the user's file.
#pragma once

#include <cstdint>

namespace rodsweep {

/// Residuals and right-hand sides with no larger entry than this are rounding errors: entries are dimensionless and of
/// order 1.
inline constexpr double rounding_level = 1e-13;

/// The numbers are stored in files (/solves/outcome); never renumber.
enum class SolveOutcome : std::int8_t {
  not_run = 0,          ///< the row was never solved (Newton had converged, or the task ended early)
  converged = 1,        ///< the tolerance was met
  zero_rhs = 2,         ///< b is zero to rounding (rounding_level): nothing to solve, zero iterations
  iteration_limit = 3,  ///< the limit of iterations, or that of rounding, was reached first
  diverged = 4,         ///< the residual exceeded the divergence limit
  indefinite = 5,       ///< the matrix or the preconditioner is not positive definite
  not_a_number = 6,     ///< a NaN or infinity appeared
};

inline const char* to_string(SolveOutcome outcome) {
  switch (outcome) {
    case SolveOutcome::not_run: return "not_run";
    case SolveOutcome::converged: return "converged";
    case SolveOutcome::zero_rhs: return "zero_rhs";
    case SolveOutcome::iteration_limit: return "iteration_limit";
    case SolveOutcome::diverged: return "diverged";
    case SolveOutcome::indefinite: return "indefinite";
    case SolveOutcome::not_a_number: return "not_a_number";
  }
  return "unknown";
}

}  // namespace rodsweep
