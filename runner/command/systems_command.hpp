// The command `systems`: repeats one task of a results file and writes the linear systems that it solves: A, b, the
// solution, and the rods' states. One process; needs PETSc. The new file is created when the task ends.
// Throws FileError and Hdf5Error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct SystemsOptions {
  std::filesystem::path file;
  std::int64_t task = 0;
  std::optional<std::filesystem::path> output;  ///< default: FILE-systems-N.h5 in FILE's folder
  int every = 10;                               ///< steps
  bool first = false;                           ///< of each step only the first Newton iteration
  std::string command;                          ///< the whole command line, for the file
};

inline constexpr const char* systems_help =
    "The job is read from FILE, not from its job file. Relative paths start at the folder of the job file. Nothing is\n"
    "kept in sweeps for this: the same task solves the same systems again.\n"
    "In Python, rodsweep.systems(\"OUTPUT\") has A as a scipy matrix; rodsweep-matrices writes other formats.\n"
    "SIGTERM, SIGINT (Ctrl-C) and SIGUSR1 stop it within seconds; then nothing is written.\n\n"
    "Examples:\n"
    "  rodsweep systems results/demo.h5 12                      every tenth step into results/demo-systems-12.h5\n"
    "  rodsweep systems results/demo.h5 12 --every 1 --first -o all.h5\n\n"
    "Exit codes:\n"
    "  0  written\n"
    "  2  error in the command line or the file; nothing was written\n"
    "  3  the task failed; its systems up to there are written\n"
    "  4  stopped early; nothing was written";

ExitCode execute(const SystemsOptions& options, Console& console);

}  // namespace rodsweep
