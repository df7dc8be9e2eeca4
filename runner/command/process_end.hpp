// The end of this process. Only the program may end it: a user's code that calls exit(), such as os._exit() in a guess,
// would end a run with exit code 0 and with tasks left to do. So the program says when it ends, and its exit()
// (foreign_exit.cpp) makes an error of any other end.
#pragma once

#include "runner/command/exit_codes.hpp"

namespace rodsweep {

class MpiSession;

/// To be called before main() returns, and before a function that ends the process, such as MPI_Abort.
void process_ends() noexcept;
bool process_is_ending() noexcept;

/// Ends this process at once, without waiting for anything.
[[noreturn]] void leave(ExitCode code);

/// Ends this rank after others were lost, without MPI_Finalize, which would wait for them. Rank 0 also ends the others.
[[noreturn]] void leave_lost_ranks(const MpiSession& mpi, ExitCode code);

// The program's own exit(), _exit() and the like, which libraries find before those of the C library. An end of the
// process that a user's code asks for, or with exit code 0 any other library, becomes an error with a message.
// Processes that such code forks may end as they like.

/// Sets the exit code of such an end (default: user_error), and the end of its message.
void expect_no_exit(ExitCode code, const char* advice) noexcept;

}  // namespace rodsweep
