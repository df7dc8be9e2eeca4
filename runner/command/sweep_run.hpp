// A sweep (or data set) run: the job is planned, its file created or continued, its tasks dispatched, and the end
// summed up. Rank 0 is the master, the others are workers; a lone rank is both.
#pragma once

#include "runner/command/run_command.hpp"
#include "runner/job/job.hpp"

namespace rodsweep {

/// Part of execute(RunOptions); `job`: of options.job, the same on every rank.
ExitCode run_sweep(const RunOptions& options, const Job& job, const MpiSession& mpi, Console& console);

}  // namespace rodsweep
