// The command `rerun`: one task of a results file once more, from the job in the file, with its trajectory, into a file
// of its own; then what it wrote is compared with what the sweep has. One process; needs PETSc. The new file appears
// when the task is through. Throws FileError and Hdf5Error.
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
  std::optional<std::filesystem::path> output;  ///< default: FILE's name with "-task-N", beside it
  int trajectory_every = 1;
  std::string command;  ///< the whole line, for /runs
};

/// tasks_failed if the results differ from those in the file, or if it has none and the task fails; stopped after a
/// signal, and then nothing is written.
ExitCode rerun_task(const RerunOptions& options, Console& console);

}  // namespace rodsweep
