// The command `run`, collective over all ranks: a job of kind "train" trains a model (training_run.cpp); any other job is
// a sweep or makes a data set (sweep_run.cpp).
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "runner/command/exit_codes.hpp"
#include "runner/command/shard.hpp"
#include "runner/file/provenance.hpp"
#include "runner/job/job.hpp"
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
  std::optional<int> workers;                   ///< starts mpirun with these workers
  int max_crashes = 3;                          ///< a task is not retried after this many worker deaths
  double worker_timeout_s = 120;                ///< a worker without heartbeat for this long is lost; 0: no timeout
  std::string program = "rodsweep";             ///< as the user typed it
  std::string command;                          ///< the whole command line, for /runs
};

inline constexpr const char* run_help =
    "A single rank runs the tasks itself. With -n N, N workers run them, and a master that sleeps sends them: mpirun\n"
    "starts N+1 ranks on this machine. On several hosts, start mpirun or srun yourself, with one rank more than "
    "cores.\n"
    "A training (kind \"train\") has no master. One rank uses all its cores, up to training.shards and\n"
    "OMP_NUM_THREADS. On several hosts, use one rank per host.\n\n"
    "SIGTERM, SIGINT (Ctrl-C), SIGUSR1, SIGUSR2, SIGXCPU and SIGHUP (unless ignored, as by nohup) stop the sweep\n"
    "within seconds. Running tasks are abandoned, also within a solve; finished tasks are kept. mpirun passes SIGUSR1\n"
    "and SIGUSR2 to all ranks and exits with 4. On SIGTERM and SIGINT it kills ranks that still run a second later,\n"
    "and exits with 1. Every stopped sweep can be resumed.\n"
    "A training stops between two steps; --resume continues it with bitwise equal results.\n\n"
    "Examples:\n"
    "  rodsweep run jobs/smoke.json                        one core, results/smoke.h5\n"
    "  rodsweep run job.json -n 4                          4 cores\n"
    "  mpirun -n 65 rodsweep run job.json -o out.h5 --resume\n"
    "                                                      on several hosts; continues or creates out.h5: for batch\n"
    "                                                      scripts\n"
    "  rodsweep run job.json -o out.h5 --resume --retry-failed\n"
    "                                                      also repeats errors, timeouts and crashes\n"
    "  rodsweep run job.json -o out.h5 --resume --retry-failed --task-time-limit 3600\n"
    "                                                      the same, with an hour for each task\n"
    "  rodsweep run job.json -n 2 --memory-limit-gb 20\n"
    "                                                      instead of an equal share for each worker\n"
    "  rodsweep run more.json -o more.h5 --extend out.h5   more.json: job.json with more samples or more grid values.\n"
    "                                                      Copies the results of out.h5 and runs the other tasks.\n"
    "                                                      out.h5 stays unchanged; more.h5 equals a full new run.";

/// Starts PETSc. All ranks return the same result. Throws CollectiveError on all ranks if the run cannot start (a job
/// or file error). Any other exception concerns one rank only; the caller must abort, because the others wait for it.
ExitCode execute(const RunOptions& options, const MpiSession& mpi, Console& console);

/// The two parts of execute(). `job` is read from options.job and is the same on every rank.
ExitCode run_sweep(const RunOptions& options, const Job& job, const MpiSession& mpi, Console& console);
ExitCode run_training(const RunOptions& options, const Job& job, const MpiSession& mpi, Console& console);

/// The ranks of a run with options.workers; 1 without.
int ranks_of(const RunOptions& options, const Job& job);

/// The results file: the user's choice; default results/NAME.h5, or results/NAME-IofN.h5 for a shard.
/// Throws FileError if it is a folder.
std::filesystem::path output_of(const RunOptions& options, const std::string& job_name);

/// The row of /runs for a start on these ranks.
Provenance provenance_of(const RunOptions& options, const MpiSession& mpi, const Placement& where);

}  // namespace rodsweep
