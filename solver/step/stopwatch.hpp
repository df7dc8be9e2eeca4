// Times of a few statements [s]: wall time from a monotonic clock or a test's clock, and processor time.
#pragma once

#include <time.h>

#include <algorithm>
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

/// Processor time of all threads of the process: waiting does not count, nor do other processes and accelerators. A
/// reading takes some 0.4 us, and that of the end is not counted.
class ProcessorStopwatch {
 public:
  ProcessorStopwatch() : start_(now()) {}

  double seconds() const {
    static const double reading = std::min({between(), between(), between(), between()});
    return std::max(0.0, now() - start_ - reading);
  }

 private:
  static double now() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  /// The time of nothing.
  static double between() {
    const double before = now();
    return now() - before;
  }

  double start_;
};

}  // namespace rodsweep
