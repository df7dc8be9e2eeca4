// Runs a sweep or makes a data set: plans the job, creates or continues its file, dispatches its tasks, and prints a
// summary. Rank 0 is the master, the others are workers; a single rank is both.
#pragma once

#include "runner/command/run_command.hpp"
#include "runner/job/job.hpp"

namespace rodsweep {

/// Part of execute(RunOptions). `job` is read from options.job and is the same on every rank.
ExitCode run_sweep(const RunOptions& options, const Job& job, const MpiSession& mpi, Console& console);

}  // namespace rodsweep
