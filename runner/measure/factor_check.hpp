// Checks before a run whether a factorisation would exceed its memory limit (solver/factor/elimination_plan.hpp).
// Only rods with thousands of joints can exceed it, that have loops or very many joints on one segment. Each size of such
// rods in a job is checked once, in about a second per 100,000 joints.
#pragma once

#include "runner/plan/plan.hpp"
#include "solver/factor/elimination_plan.hpp"

namespace rodsweep {

/// Throws JobError with the memory needed and an alternative that needs no factor.
void check_factors(const Plan& plan, double most_bytes = most_factor_bytes);

}  // namespace rodsweep
