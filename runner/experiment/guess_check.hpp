// Guesses that are not for the rods or with the model that a job gives them, found before anything runs.
//
// Nearest neighbours compare rods along one arc length, which loops and branches do not have; several corrections,
// lag_steps and stop_at are for models with factors.
#pragma once

#include "runner/job/plan.hpp"

namespace rodsweep {

/// Throws JobError, naming the guess; FileError where a model file that it needs is not one.
void check_guesses(const Plan& plan);

}  // namespace rodsweep
