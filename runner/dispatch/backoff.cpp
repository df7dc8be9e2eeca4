#include "runner/dispatch/backoff.hpp"

#include <sched.h>

#include <algorithm>
#include <thread>

namespace rodsweep {

void Backoff::wait() {
  using std::chrono::microseconds;
  constexpr int spins = 50;
  if (polls_ < spins) {
    ++polls_;
    pause_ = microseconds(50);
    sched_yield();
    return;
  }
  std::this_thread::sleep_for(pause_);
  pause_ = std::min(pause_ + pause_ / 2, microseconds(2000));
}

}  // namespace rodsweep
