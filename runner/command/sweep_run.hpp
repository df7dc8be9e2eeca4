// The command `run`: a job is planned, its file created or continued, its tasks dispatched, and the end summed up.
//
// Collective over all ranks. Rank 0 is the master, the others are workers; a lone rank is both.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "runner/command/exit_codes.hpp"
#include "runner/job/job.hpp"
#include "runner/mpi/mpi_session.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct RunOptions {
  std::filesystem::path job;
  std::optional<std::filesystem::path> output;  ///< default: results/NAME.h5 in the current folder
  bool resume = false;                          ///< continue the output if it exists
  std::optional<std::filesystem::path> extend;  ///< results of a smaller job, which need not be computed again
  std::string program = "rodsweep";             ///< as the user typed it
  std::string command;                          ///< the whole line, for /runs
};

/// Needs PETSc. `job`: of options.job, the same on every rank. The same result on every rank. Throws CollectiveError,
/// the same on every rank, when nothing could be started (a job or file error); any other exception belongs to this
/// rank alone, and the others wait for it in vain: the caller must abort.
ExitCode run_sweep(const RunOptions& options, const Job& job, const MpiSession& mpi, Console& console);

/// results/NAME.h5
std::filesystem::path default_output(const std::string& job_name);

/// Of a sweep on so many cores: the master sleeps.
int ranks_for(int workers);

/// The line to type for this job on so many ranks: "mpirun --oversubscribe -n 3 rodsweep run jobs/demo.json".
std::string run_command(const RunOptions& options, int ranks);

}  // namespace rodsweep
