#include "solver/linear/solve_outcome.hpp"

namespace rodsweep {

const char* to_string(SolveOutcome outcome) {
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
