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
    "The files are of one job, and each holds what was finished of it: shards of a job array, say. The new file holds\n"
    "all that any of them does, bit for bit what a single run would have written, and remembers who ran what, when\n"
    "and where. Tasks are compared with their checksums: a damaged one is left to do. What two files hold is taken\n"
    "from the first, with a warning where their results differ. What nobody finished is pending, and\n"
    "`rodsweep run JOB -o OUTPUT --resume` goes on there.\n\n"
    "Examples:\n"
    "  rodsweep run job.json --shard 1/2                results/NAME-1of2.h5, here\n"
    "  rodsweep run job.json --shard 2/2                results/NAME-2of2.h5, there\n"
    "  rodsweep merge results/NAME-*of2.h5 -o results/NAME.h5\n"
    "  sbatch --array=1-16 jobs/slurm/sweep.sbatch job.json";

ExitCode execute(const MergeOptions& options, Console& console);

}  // namespace rodsweep
