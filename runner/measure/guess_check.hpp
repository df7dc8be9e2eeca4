// Checks before a run that guesses, and networks that replace the solve, fit the job's rods and models.
//
// Nearest neighbours compare rods by arc length, so they need rods without loops and branches. Several corrections,
// lag_steps and stop_at need a model with factors. A model of the encoding "state" works only with state_network.
#pragma once

#include "runner/plan/plan.hpp"

namespace rodsweep {

/// Throws JobError with the key, or FileError for a file that is not a model.
void check_guesses(const Plan& plan);

}  // namespace rodsweep
