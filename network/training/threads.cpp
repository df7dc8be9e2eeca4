#include "network/training/threads.hpp"

#include <omp.h>

#include <algorithm>
#include <exception>

namespace rodsweep {

int available_threads() { return omp_get_max_threads(); }

void in_parallel(int count, int threads, const std::function<void(int item, int thread)>& work) {
  std::exception_ptr failure;
#pragma omp parallel for schedule(dynamic, 1) num_threads(std::max(1, std::min(threads, count)))
  for (int item = 0; item < count; ++item) {
    try {
      work(item, omp_get_thread_num());
    } catch (...) {
#pragma omp critical
      failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace rodsweep
