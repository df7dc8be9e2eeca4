// The command `run`: a job of kind "train" trains a model (training_run.hpp); any other job is a sweep (sweep_run.hpp).
// Collective over all ranks.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "runner/command/exit_codes.hpp"
#include "runner/command/shard.hpp"
#include "runner/file/provenance.hpp"
#include "runner/mpi/mpi_session.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct RunOptions {
  std::filesystem::path job;
  std::optional<std::filesystem::path> output;  ///< default: results/NAME.h5 in the current folder
  bool resume = false;                          ///< continue the output if it exists
  bool retry_failed = false;  ///< with `resume`: repeat tasks that ended in an error, timed out or crashed
  std::optional<std::filesystem::path> extend;  ///< results of a smaller job to reuse
  std::optional<Shard> shard;                   ///< run only its tasks
  std::optional<double> task_time_limit_s;      ///< replaces the job's limit
  std::optional<double> memory_limit_gb;        ///< per rank; default: a share of the host's memory
  std::optional<double> time_limit_s;           ///< of this start
  double time_passed_s = 0;                     ///< part of that limit used before this start
  int max_crashes = 3;                          ///< a task is not retried after this many worker deaths
  double worker_timeout_s = 120;                ///< a worker without heartbeat for this long is lost; 0: no timeout
  std::string program = "rodsweep";             ///< as the user typed it
  std::string command;                          ///< the whole command line, for /runs
};

inline constexpr const char* run_help =
    "One rank runs the tasks itself; of more, rank 0 hands them out and sleeps, so C cores want C+1 ranks.\n"
    "Open MPI refuses more ranks than cores unless told --oversubscribe; inside containers as root it also\n"
    "wants --allow-run-as-root.\n"
    "A training (kind \"train\") has no master: one rank works on all its cores, at most training.shards of them,\n"
    "or on as many as OMP_NUM_THREADS says; ranks are for several hosts, one on each.\n\n"
    "SIGTERM, SIGINT (Ctrl-C) and SIGUSR1 stop the sweep, within seconds: running tasks are abandoned, in the\n"
    "middle of a solve too, finished ones are in the file. mpirun hands SIGUSR1 on to all ranks and then exits 4 as "
    "well. On SIGTERM and\n"
    "SIGINT it kills what still runs a second later, and itself exits 1. However a sweep ended, it can be resumed.\n"
    "A training stops between two steps and goes on from there, to the same bits.\n\n"
    "Examples:\n"
    "  rodsweep run jobs/smoke.json                        one core, results/smoke.h5\n"
    "  mpirun --oversubscribe -n 5 rodsweep run job.json   4 cores\n"
    "  mpirun -n 5 rodsweep run job.json -o out.h5 --resume\n"
    "                                                      continues out.h5, or starts it: for batch scripts\n"
    "  rodsweep run job.json -o out.h5 --resume --retry-failed\n"
    "                                                      and tasks again that ended in an error, timed out or "
    "crashed\n"
    "  rodsweep run job.json -o out.h5 --resume --retry-failed --task-time-limit 3600\n"
    "                                                      and give each an hour, whatever the job says\n"
    "  mpirun -n 3 rodsweep run job.json --memory-limit-gb 20\n"
    "                                                      in place of an equal share for each worker\n"
    "  rodsweep run more.json -o more.h5 --extend out.h5   more.json: job.json with more samples, more values in a\n"
    "                                                      grid, or more guesses. Copies what out.h5 holds, tries\n"
    "                                                      new guesses alone on its trajectories, runs the rest.\n"
    "                                                      out.h5 is read only; more.h5 is as if run from scratch.";

/// Starts PETSc. All ranks return the same result. Throws CollectiveError on all ranks if the run cannot start (a job
/// or file error). Any other exception concerns one rank only; the caller must abort, because the others wait for it.
ExitCode execute(const RunOptions& options, const MpiSession& mpi, Console& console);

/// The results file: the user's choice; default results/NAME.h5, or results/NAME-IofN.h5 for a shard.
std::filesystem::path output_of(const RunOptions& options, const std::string& job_name);

/// The row of /runs for a start on these ranks.
Provenance provenance_of(const RunOptions& options, const MpiSession& mpi, const Placement& where);

}  // namespace rodsweep
