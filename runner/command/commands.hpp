// The command line, and the commands beside `run`: their options as parsed, and what executes them. Each throws
// JobError for an error of a job, FileError and Hdf5Error for one of a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "runner/command/exit_codes.hpp"
#include "runner/command/run_command.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

/// The command `plan`: the extent and estimated cost of a job. No MPI; probes need PETSc.
struct PlanOptions {
  std::filesystem::path job;
  bool probe = true;
  bool json = false;
  int workers = 0;                   ///< 0: one per core of this host
  std::string program = "rodsweep";  ///< as the user typed it
};
ExitCode execute(const PlanOptions& options, Console& console);

/// The command `validate`: checks jobs. No MPI.
struct ValidateOptions {
  std::vector<std::filesystem::path> jobs;
  bool later = false;  ///< accept missing files; they must exist when the job runs
};
/// Reports whether each job is valid; continues after an invalid one. A missing file is an error unless another given
/// job makes it, or `later` is set.
ExitCode execute(const ValidateOptions& options, Console& console);

/// The command `status`: the progress of a sweep or a training, and where each task of a live sweep runs. No MPI.
struct StatusOptions {
  std::filesystem::path file;
  bool json = false;
  double watch_s = 0;  ///< repeat at this interval until no run writes the file; 0: print once
};
ExitCode execute(const StatusOptions& options, Console& console);

/// The command `info`: the content and provenance of a results file or a model. No MPI.
struct InfoOptions {
  std::filesystem::path file;
  bool verify = false;
  bool job = false;  ///< print only the job's text
  bool json = false;
};
ExitCode execute(const InfoOptions& options, Console& console);

/// The command `rerun`: repeats one task of a results file, from the job in that file, and records its trajectory in a
/// new file. One process; needs PETSc. The new file is created when the task ends.
struct RerunOptions {
  std::filesystem::path file;
  std::int64_t task = 0;
  std::optional<std::filesystem::path> output;  ///< default: FILE-task-N.h5 in FILE's folder
  int trajectory_every = 1;
  std::string program = "rodsweep";  ///< as the user typed it
  std::string command;               ///< the whole command line, for /runs
};
/// Returns tasks_failed if the task fails, stopped after a signal; then nothing is written.
ExitCode execute(const RerunOptions& options, Console& console);

/// The command `systems`: repeats one task of a results file and writes the linear systems that it solves: A, b, the
/// solution, and the rods' states. One process; needs PETSc. The new file is created when the task ends.
struct SystemsOptions {
  std::filesystem::path file;
  std::int64_t task = 0;
  std::optional<std::filesystem::path> output;  ///< default: FILE-systems-N.h5 in FILE's folder
  int every = 10;                               ///< steps
  bool first = false;                           ///< of each step only the first Newton iteration
  std::string command;                          ///< the whole command line, for the file
};
ExitCode execute(const SystemsOptions& options, Console& console);

/// The command `merge`: combines results files of the same job, for example of shards (run --shard) or of runs on
/// different machines.
struct MergeOptions {
  std::vector<std::filesystem::path> files;
  std::filesystem::path output;
  std::string command;  ///< the whole command line, for /runs
};
ExitCode execute(const MergeOptions& options, Console& console);

/// A command that is a separate program: `rodsweep query FILE` starts `rodsweep-query FILE`, as git does for unknown
/// commands. Search order: the folder of this program, the scripts of a source tree (build/../analysis/), PATH.
struct ExternalCommand {
  std::string name;                ///< "query"
  std::vector<std::string> words;  ///< the arguments
  std::string unknown;             ///< the message if the program is not found
};
/// Empty if not found. `program`: the path of this program; `path`: formatted like the environment variable PATH.
std::filesystem::path find_command(const std::string& name, const std::filesystem::path& program,
                                   const std::string& path);
/// Does not return if the program starts.
ExitCode execute(const ExternalCommand& command, Console& console);

/// The command `schema`: the JSON Schema of jobs, and what readers of files need to know besides the files, under
/// "x-files", from which `make schema` makes constants of the Python package: versions of the files, outcomes of tasks,
/// columns of /tasks that are known before a task runs, names of the job's keys whose values are paths, and the default of
/// solve.iterations, which has no column if no task sets it.
std::string schema_text();

/// Text to print instead of a command to run: help, version, schema, or a command-line error.
struct PrintedText {
  std::string text;
  ExitCode code = ExitCode::ok;
};

using Command = std::variant<RunOptions, PlanOptions, ValidateOptions, StatusOptions, InfoOptions, RerunOptions,
                             SystemsOptions, MergeOptions, ExternalCommand, PrintedText>;

/// Parses the command line, in command_line.cpp. Runs, prints and starts nothing.
Command parse_command_line(int argc, const char* const* argv);

// The ranks of a run on this machine, for `run --workers`: in launch.cpp.

/// Whether mpirun, srun or another launcher started this process as a rank.
bool is_launched();

/// Warns of a launcher that started several processes which do not know of each other, such as srun without PMIx; empty
/// if the `ranks` of this world are all that it started.
std::string separate_processes_text(int ranks);

/// Runs mpirun with `ranks` ranks of this program, all with the arguments of this process, and returns its exit code.
/// Settings of Open MPI for one machine are those of mpi-env.sh. mpirun gets the signals that request a stop. Its
/// standard output is printed here, because mpirun ignores failed writes.
ExitCode launch(int ranks, Console& console);

}  // namespace rodsweep
