// The table of everything that a job file may say. A new scene, guess, setting or kind of job is a row here (and its
// counterpart in runner/job/task_spec.cpp, which turns values into the solver's types).
#pragma once

#include <vector>

#include "runner/job/key.hpp"

namespace rodsweep {

/// The whole job: an object whose `kind` decides which keys it has.
const Key& job_key();

/// Initial guesses by name, each an object of its parameters.
const std::vector<Key>& guess_keys();

/// `label`, which any entry of the list of guesses may have beside its parameters or its sweep.
const Key& guess_label_key();

}  // namespace rodsweep
