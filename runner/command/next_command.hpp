// The command line to suggest next: a run, or a script of analysis/ on a new file.
#pragma once

#include <filesystem>
#include <string>

#include "runner/command/run_command.hpp"

namespace rodsweep {

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
