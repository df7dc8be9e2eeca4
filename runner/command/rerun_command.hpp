// The command `rerun`: repeats one task of a results file, from the job in that file, and records its trajectory in a
// new file. One process; needs PETSc. The new file is created when the task ends. Throws FileError and Hdf5Error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct RerunOptions {
  std::filesystem::path file;
  std::int64_t task = 0;
  std::optional<std::filesystem::path> output;  ///< default: FILE-task-N.h5 in FILE's folder
  int trajectory_every = 1;
  std::string program = "rodsweep";  ///< as the user typed it
  std::string command;               ///< the whole command line, for /runs
};

inline constexpr const char* rerun_help =
    "The job is read from FILE, not from its job file. Relative paths start at the folder of the job file. The new\n"
    "file holds one task; all commands can read it: `rodsweep compare FILE NEW` says whether the results are the "
    "same.\n"
    "SIGTERM, SIGINT (Ctrl-C) and SIGUSR1 stop it within seconds; then nothing is written.\n\n"
    "Examples:\n"
    "  rodsweep rerun results/demo.h5 12                               every step into results/demo-task-12.h5\n"
    "  rodsweep rerun results/long.h5 3 --trajectory-every 100 -o three.h5\n"
    "  rodsweep compare results/long.h5 three.h5\n\n"
    "Exit codes:\n"
    "  0  the task is ok\n"
    "  2  error in the command line or the file; nothing was written\n"
    "  3  the task failed; its results were written\n"
    "  4  stopped early; nothing was written";

/// Returns tasks_failed if the task fails, stopped after a signal; then nothing is written.
ExitCode execute(const RerunOptions& options, Console& console);

}  // namespace rodsweep
