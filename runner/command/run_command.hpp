// The command `run`, collective over all ranks: a job of kind "train" trains a model (training_run.cpp); any other job is
// a sweep or makes a data set (sweep_run.cpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "runner/command/exit_codes.hpp"
#include "runner/file/provenance.hpp"
#include "runner/job/job.hpp"
#include "runner/mpi/mpi_session.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

/// A shard: one of the parts of a sweep's tasks (`run --shard 3/16`). Each shard has its own results file; `merge`
/// combines these files.
struct Shard {
  int number = 1;  ///< from 1
  int of = 1;
};

/// Parses "3/16"; none if `text` is not a valid shard.
std::optional<Shard> shard_of(const std::string& text);

/// The number of tasks in the shard, for a sweep of `tasks` tasks.
std::int64_t share_of(const Shard& shard, std::int64_t tasks);

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

// The command line to suggest next: a run, or a script of analysis/ on a new file.

/// Ranks of a sweep with this many workers: one more for the master, which sleeps; 1 for a single worker.
int ranks_for(int workers);

/// The command for this job on this many ranks: "mpirun --oversubscribe -n 3 rodsweep run jobs/demo.json", or
/// "rodsweep run jobs/demo.json -n 2" with options.workers.
std::string run_line(const RunOptions& options, int ranks);

/// "stopped early by SIGTERM; nothing is lost. To continue: " and the command.
std::string stopped_text(int signal, RunOptions options, int ranks);

/// For a shard's file with the default name: "rodsweep merge results/demo-*of4.h5 -o results/demo.h5"; for other names:
/// "rodsweep merge SHARDS... -o FILE".
std::string merge_line(const std::string& program, const std::filesystem::path& file, const Shard& shard);

/// "rodsweep compare results/demo.h5 results/demo-task-12.h5".
std::string compare_line(const std::string& program, const std::filesystem::path& file,
                         const std::filesystem::path& other);

/// "/usr/bin/python3 analysis/summary.py results/demo.h5". The script is that of this program's source tree or
/// installation; its path is relative to the current folder where possible.
std::string script_line(const std::string& script, const std::filesystem::path& file);

}  // namespace rodsweep
