// The program's own exit(), _exit() and the like, which libraries find before those of the C library. An end of the
// process that a user's code asks for, or with exit code 0 any other library, becomes an error with a message.
// Processes that such code forks may end as they like.
#pragma once

#include "runner/command/exit_codes.hpp"

namespace rodsweep {

/// Sets the exit code of such an end (default: user_error), and the end of its message.
void expect_no_exit(ExitCode code, const char* advice) noexcept;

}  // namespace rodsweep
