#include "solver/outcome.hpp"

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

const char* to_string(TaskOutcome outcome) {
  switch (outcome) {
    case TaskOutcome::pending: return "pending";
    case TaskOutcome::ok: return "ok";
    case TaskOutcome::diverged: return "diverged";
    case TaskOutcome::not_a_number: return "not_a_number";
    case TaskOutcome::indefinite: return "indefinite";
    case TaskOutcome::iteration_limit: return "iteration_limit";
    case TaskOutcome::timed_out: return "timed_out";
    case TaskOutcome::error: return "error";
  }
  return "unknown";
}

}  // namespace rodsweep
