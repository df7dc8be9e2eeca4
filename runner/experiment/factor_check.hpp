// Scenes whose direct solve would need more memory than a factor may have (solver/factor/elimination_plan.hpp), found
// before anything runs. Only rods with loops and thousands of joints can; of those that a job has, each size is looked
// at once, in about a second per 100,000 joints.
#pragma once

#include "runner/plan/plan.hpp"
#include "solver/factor/elimination_plan.hpp"

namespace rodsweep {

/// Throws JobError, naming what the solve would need and what does without it.
void check_factors(const Plan& plan, double most_bytes = most_factor_bytes);

}  // namespace rodsweep
