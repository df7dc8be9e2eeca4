// Guesses, and networks in place of the solve, that are not for the rods or with the model that a job gives them, found
// before anything runs.
//
// Nearest neighbours compare rods along one arc length, which loops and branches do not have; several corrections,
// lag_steps and stop_at are for models with factors; a model of states is for state_network alone.
#pragma once

#include "runner/plan/plan.hpp"

namespace rodsweep {

/// Throws JobError, naming the key; FileError where a model file that it needs is not one.
void check_guesses(const Plan& plan);

}  // namespace rodsweep
