// What to type next: a run, or a script of analysis/ on a file that was just made.
#pragma once

#include <filesystem>
#include <string>

#include "runner/command/run_command.hpp"

namespace rodsweep {

/// Of a sweep on so many cores: the master sleeps.
int ranks_for(int workers);

/// The line to type for this job on so many ranks: "mpirun --oversubscribe -n 3 rodsweep run jobs/demo.json".
std::string run_line(const RunOptions& options, int ranks);

/// "stopped early by SIGTERM; nothing is lost. To continue: " and the line.
std::string stopped_text(int signal, RunOptions options, int ranks);

/// Of a shard's file, with the others beside it: "rodsweep merge results/demo-*of4.h5 -o results/demo.h5"; of files
/// named otherwise "rodsweep merge SHARDS... -o FILE".
std::string merge_line(const std::string& program, const std::filesystem::path& file, const Shard& shard);

/// "/usr/bin/python3 analysis/summary.py results/demo.h5", the script being that of the source tree or installation
/// that this program belongs to, as typed from here.
std::string script_line(const std::string& script, const std::filesystem::path& file);

}  // namespace rodsweep
