// Does a job hold all of an earlier one and more of it? More samples, more values in a grid or zip (a plain value may
// become a grid that holds it), more guesses, in any order; name and description do not count, nor do the paths to
// files of the same bytes. Everything else must be as it was, the seed first of all.
#pragma once

#include "runner/job/job.hpp"

namespace rodsweep {

/// Throws JobError that names the first key in which `job` is not such an extension of `before`, with both values and
/// what to do.
void check_extends(const Job& job, const Job& before);

}  // namespace rodsweep
