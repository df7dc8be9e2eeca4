// The program's exit codes. Scripts and schedulers rely on these numbers; --help lists them.
#pragma once

namespace rodsweep {

enum class ExitCode : int {
  ok = 0,            ///< success
  user_error = 2,    ///< refused: an error in the command line, a job or a file; nothing was computed
  tasks_failed = 3,  ///< the sweep is complete but some tasks failed
  stopped = 4,       ///< stopped early by a signal, the time limit or an error such as a full disk; --resume continues
  too_long = 5,      ///< stopped early; no task ended within the time limit, or all tasks left exceed the memory
  lost = 6,          ///< stopped early because all workers were lost; --resume continues
  output_lost = 7,   ///< standard output could not be written; everything else succeeded
  differ = 8,        ///< the compared results differ
  diverged = 9,      ///< a training diverged; its best model is kept
  damaged = 10,      ///< results in the file are not those that were written
};

}  // namespace rodsweep
