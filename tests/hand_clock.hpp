// A TimeSource that tests advance by hand.
#pragma once

#include <atomic>

#include "solver/step/stopwatch.hpp"

namespace rodsweep::test {

class HandClock {
 public:
  using Seconds = std::chrono::duration<double>;

  static TimePoint now() { return time_; }
  static void pass(Seconds time) { time_ = time_.load() + std::chrono::duration_cast<TimePoint::duration>(time); }

  /// The time by which each call of ticking() advances the clock.
  static void set_tick(Seconds tick) { tick_ = tick; }
  static TimePoint ticking() {
    pass(tick_);
    return time_;
  }

 private:
  static inline std::atomic<TimePoint> time_{};  ///< also read by the thread that looks after calls of user's code
  static inline Seconds tick_{0};
};

}  // namespace rodsweep::test
