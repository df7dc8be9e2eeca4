// A clock that tests move by hand, as a TimeSource.
#pragma once

#include "solver/step/stopwatch.hpp"

namespace rodsweep::test {

class HandClock {
 public:
  using Seconds = std::chrono::duration<double>;

  static TimePoint now() { return time_; }
  static void pass(Seconds time) { time_ += std::chrono::duration_cast<TimePoint::duration>(time); }

  /// Moves on by `tick` whenever it is read.
  static void set_tick(Seconds tick) { tick_ = tick; }
  static TimePoint ticking() {
    pass(tick_);
    return time_;
  }

 private:
  static inline TimePoint time_{};
  static inline Seconds tick_{0};
};

}  // namespace rodsweep::test
