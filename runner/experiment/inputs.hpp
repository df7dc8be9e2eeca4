// Checks a job's input files before a run.
#pragma once

#include "runner/job/job.hpp"

namespace rodsweep {

/// Opens each file of the job, except accepted missing ones, as a model or a data set according to its key. Throws
/// JobError with the key and the reason.
void check_inputs(const Job& job);

}  // namespace rodsweep
