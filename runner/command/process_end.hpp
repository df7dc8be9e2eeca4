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

}  // namespace rodsweep
