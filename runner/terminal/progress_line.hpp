// Shows the progress of a run: a bar at the bottom of a terminal, or lines in a log at growing intervals, so that logs
// of long runs stay short.
#pragma once

#include <chrono>
#include <string>

#include "runner/terminal/console.hpp"

namespace rodsweep {

/// A bar and the text, or what of the text is narrower than this many columns; 0: any width.
std::string progress_line(double fraction, const std::string& text, int columns);

class ProgressLine {
 public:
  using Clock = std::chrono::steady_clock;

  ProgressLine(Console& console, Clock::time_point now);

  bool due(Clock::time_point now) const { return now >= next_; }
  /// Call when due. `fraction`: completed share of the work.
  void show(Clock::time_point now, double fraction, const std::string& text);
  void clear();  ///< removes the bar

 private:
  Console* console_;
  Clock::time_point next_;
  Clock::duration pause_;
};

}  // namespace rodsweep
