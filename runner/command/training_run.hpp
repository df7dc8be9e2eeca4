// The command `run` for a job of kind "train": the data set is read, the network trained by all ranks, and the model
// kept in a file, from which a training that was interrupted goes on.
//
// Collective over all ranks. Nobody is master: every rank reads the data set and works; rank 0 also writes the file.
#pragma once

#include "runner/command/exit_codes.hpp"
#include "runner/command/sweep_run.hpp"
#include "runner/job/job.hpp"
#include "runner/mpi/mpi_session.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

/// Needs PETSc. The same result on every rank. Throws CollectiveError, the same on every rank, when nothing could be
/// started; any other exception belongs to this rank alone, and the caller must abort.
ExitCode run_training(const RunOptions& options, const Job& job, const MpiSession& mpi, Console& console);

}  // namespace rodsweep
