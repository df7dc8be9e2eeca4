// Work shared by the threads of a process: who does what is left open, so that results must not depend on it.
#pragma once

#include <functional>

namespace rodsweep {

/// As many as cores that this process may run on, or as OMP_NUM_THREADS says.
int available_threads();

/// Calls work(item, thread) for the items 0 to count - 1, on at most `threads` threads numbered from 0. Throws one of
/// the exceptions that came out of it, after all items.
void in_parallel(int count, int threads, const std::function<void(int item, int thread)>& work);

}  // namespace rodsweep
