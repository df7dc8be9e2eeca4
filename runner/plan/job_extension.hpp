// Checks whether a job extends an earlier one: more samples, or more values in a grid or zip, in any order (a single
// value may become a grid that contains it). Name, description, labels of guesses and the paths of files with equal
// content may change. Everything else must be equal, above all the seed and the guesses: times of guesses are compared
// within one run.
#pragma once

#include "runner/job/job.hpp"

namespace rodsweep {

/// Throws JobError if `job` does not extend `before`, with the first different key, both values and advice.
void check_extends(const Job& job, const Job& before);
bool extends(const Job& job, const Job& before);

}  // namespace rodsweep
