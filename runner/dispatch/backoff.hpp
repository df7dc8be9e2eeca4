// Polling that leaves the core to other ranks: a short spin with sched_yield, then sleeps that grow from 50 us to 2 ms.
// Open MPI's blocking calls spin forever and take a core away from the workers.
#pragma once

#include <chrono>

namespace rodsweep {

class Backoff {
 public:
  void wait();                  ///< no message: wait, longer each time
  void reset() { polls_ = 0; }  ///< a message arrived

 private:
  int polls_ = 0;
  std::chrono::microseconds pause_{};
};

}  // namespace rodsweep
