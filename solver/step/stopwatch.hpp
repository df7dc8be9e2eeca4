// Wall time of a few statements [s], from a monotonic clock or a test's clock.
#pragma once

#include <chrono>

namespace rodsweep {

using TimePoint = std::chrono::steady_clock::time_point;
/// Returns the time.
using TimeSource = TimePoint (*)();

class Stopwatch {
 public:
  explicit Stopwatch(TimeSource now = std::chrono::steady_clock::now) : now_(now), start_(now()) {}

  double seconds() const { return std::chrono::duration<double>(now_() - start_).count(); }

 private:
  TimeSource now_;
  TimePoint start_;
};

}  // namespace rodsweep
