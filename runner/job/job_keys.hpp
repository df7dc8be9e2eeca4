// The table of everything that a job file may say. What scenes, guesses, time steps, solves and trainings have is said
// in tables of their own, beside what is made of it.
#pragma once

#include "runner/job/key.hpp"

namespace rodsweep {

/// The whole job: an object whose `kind` decides which keys it has.
const Key& job_key();

}  // namespace rodsweep
