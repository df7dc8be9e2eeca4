// A training run: the data set is read, the network trained by all ranks, and the model
// kept in a file, from which a training that was interrupted goes on.
//
// Collective over all ranks. Nobody is master: every rank reads the data set and works; rank 0 also writes the file.
#pragma once

#include "runner/command/run_command.hpp"
#include "runner/job/job.hpp"

namespace rodsweep {

/// Part of execute(RunOptions); `job`: of options.job, the same on every rank.
ExitCode run_training(const RunOptions& options, const Job& job, const MpiSession& mpi, Console& console);

}  // namespace rodsweep
