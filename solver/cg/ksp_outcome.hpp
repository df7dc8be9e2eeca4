// PETSc's reason for the end of a solve as a SolveOutcome. Included by sources only. Only our tests of convergence return
// KSP_CONVERGED_RTOL. KSPCG itself says KSP_CONVERGED_ATOL if r.z is 0 for a residual that is not: the preconditioner is
// not positive definite.
#pragma once

#include <petscksp.h>

#include "solver/linear/solve_outcome.hpp"

namespace rodsweep {

inline SolveOutcome outcome_of(KSPConvergedReason reason) {
  switch (reason) {
    case KSP_CONVERGED_RTOL: return SolveOutcome::converged;
    case KSP_DIVERGED_ITS: return SolveOutcome::iteration_limit;
    case KSP_DIVERGED_NANORINF: return SolveOutcome::not_a_number;
    case KSP_CONVERGED_ATOL:
    case KSP_DIVERGED_INDEFINITE_MAT:
    case KSP_DIVERGED_INDEFINITE_PC:
    case KSP_DIVERGED_PC_FAILED: return SolveOutcome::indefinite;
    default: return SolveOutcome::diverged;
  }
}

}  // namespace rodsweep
