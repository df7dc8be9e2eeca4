// How a rank waits without burning its core: a short spin that yields, then sleeps that grow from 50 us to 2 ms.
// Open MPI's blocking calls spin for ever, which costs the workers beside them their core.
#pragma once

#include <chrono>

namespace rodsweep {

class Backoff {
 public:
  void wait();                  ///< nothing came: wait a little, longer each time
  void reset() { polls_ = 0; }  ///< something came

 private:
  int polls_ = 0;
  std::chrono::microseconds pause_{};
};

}  // namespace rodsweep
