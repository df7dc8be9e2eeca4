// Work shared by the threads of a process. Any thread may take any item, so results must not depend on the thread.
#pragma once

#include <functional>

namespace rodsweep {

/// The number of cores that this process may use, or OMP_NUM_THREADS.
int available_threads();

/// Calls work(item, thread) for the items 0 to count - 1, on at most `threads` threads numbered from 0. If calls throw,
/// one of their exceptions is thrown after all items.
void in_parallel(int count, int threads, const std::function<void(int item, int thread)>& work);

}  // namespace rodsweep
