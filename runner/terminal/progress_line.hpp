// Where a run says how far it is: a bar at the bottom of a live terminal, a line now and then in a log, ever more
// rarely, so that a log of hours stays readable.
#pragma once

#include <chrono>
#include <string>

#include "runner/terminal/console.hpp"

namespace rodsweep {

class ProgressLine {
 public:
  using Clock = std::chrono::steady_clock;

  ProgressLine(Console& console, Clock::time_point now);

  bool due(Clock::time_point now) const { return now >= next_; }
  /// To be called when it is due; `fraction`: how much is done.
  void show(Clock::time_point now, double fraction, const std::string& text);
  void clear();  ///< takes the bar away

 private:
  Console* console_;
  Clock::time_point next_;
  Clock::duration pause_;
};

}  // namespace rodsweep
