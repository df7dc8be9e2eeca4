// What the program's exit code says. Scripts and schedulers rely on these numbers; --help lists them.
#pragma once

namespace rodsweep {

enum class ExitCode : int {
  ok = 0,            ///< all done
  user_error = 2,    ///< the command line, a job or a file: nothing was computed, or a result could not be written,
                     ///< be it to standard output, after all else went well
  tasks_failed = 3,  ///< the sweep is complete, some of its tasks failed; or a training diverged
  stopped = 4,       ///< stopped early, by a signal, its time limit, a full disk; --resume continues
  too_long = 5,      ///< likewise, and no task that is left would end within a whole time limit, or fits into memory
  lost = 6,          ///< stopped early since no worker was left; --resume continues
};

}  // namespace rodsweep
