// A training run: reads the data set, trains the network, and saves the model and checkpoints to a file. An interrupted
// training resumes from that file.
//
// Collective over all ranks. There is no master: all ranks train; rank 0 also reads the data sets and writes the file.
#pragma once

#include "runner/command/run_command.hpp"
#include "runner/job/job.hpp"

namespace rodsweep {

/// Part of execute(RunOptions). `job` is read from options.job and is the same on every rank.
ExitCode run_training(const RunOptions& options, const Job& job, const MpiSession& mpi, Console& console);

}  // namespace rodsweep
