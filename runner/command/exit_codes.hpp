// The program's exit codes. Scripts and schedulers rely on these numbers; --help lists them.
#pragma once

namespace rodsweep {

enum class ExitCode : int {
  ok = 0,            ///< all done
  user_error = 2,    ///< refused: an error in the command line, a job or a file; nothing was computed
  tasks_failed = 3,  ///< the sweep is complete, some of its tasks failed
  stopped = 4,       ///< stopped early, by a signal, its time limit, a full disk; --resume continues
  too_long = 5,      ///< likewise, and no task that is left would end within a whole time limit, or fits into memory
  lost = 6,          ///< stopped early since no worker was left; --resume continues
  output_lost = 7,   ///< standard output could not be written; all else went well
  differ = 8,        ///< the results that were compared differ
  diverged = 9,      ///< a training diverged; its best model is kept
  damaged = 10,      ///< results in the file are not those that were written
};

}  // namespace rodsweep
