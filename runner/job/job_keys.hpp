// The table of all keys of a job file. The keys of scenes, guesses, time steps, solves and trainings are in separate
// tables.
#pragma once

#include "runner/job/key.hpp"

namespace rodsweep {

/// The key of the whole job: an object whose `kind` determines its other keys.
const Key& job_key();

}  // namespace rodsweep
