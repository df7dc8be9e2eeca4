// The command `merge`: combines results files of the same job, for example of shards (run --shard) or of runs on
// different machines. Throws FileError and Hdf5Error.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct MergeOptions {
  std::vector<std::filesystem::path> files;
  std::filesystem::path output;
  std::string command;  ///< the whole command line, for /runs
};

inline constexpr const char* merge_help =
    "The files hold finished tasks of one job, for example shards of a job array. The new file holds all of them,\n"
    "bit for bit as a single run would write them. It also records which run computed each task. Damaged tasks\n"
    "(wrong checksum) are left to do. If several files hold a task, the first is used; a warning is printed if the\n"
    "results differ. All other tasks are pending: `rodsweep run JOB -o OUTPUT --resume` runs them.\n\n"
    "Examples:\n"
    "  rodsweep run job.json --shard 1/2                results/NAME-1of2.h5, on one host\n"
    "  rodsweep run job.json --shard 2/2                results/NAME-2of2.h5, on another host\n"
    "  rodsweep merge results/NAME-*of2.h5 -o results/NAME.h5\n"
    "  sbatch --array=1-16 jobs/slurm/sweep.sbatch job.json";

ExitCode execute(const MergeOptions& options, Console& console);

}  // namespace rodsweep
