// The files that a job names, looked into before anything runs: a model must be one, a data set too.
#pragma once

#include "runner/job/job.hpp"

namespace rodsweep {

/// Opens every file of the job (but those that were missing and accepted) as what its key says it is. Throws JobError
/// with the key and the reason.
void check_inputs(const Job& job);

}  // namespace rodsweep
