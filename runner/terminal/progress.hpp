// The progress of a sweep: done, failed, total, rate, time left. Shown as a bar on a terminal, as lines in a log.
//
// Tasks are dispatched longest first, so the time left is estimated from cost, not from the number of tasks:
// (b + s c) / W - t, with b the time of finished tasks, c the cost of the others, W the number of workers, t the time
// since the start, and s the seconds per unit of cost, a mean over the last 100 tasks or so. Older tasks say little:
// costs do not know the method, and the first tasks are often references.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "runner/plan/task_outcome.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

/// Shows the progress of a run: a bar at the bottom of a terminal, or lines in a log at growing intervals, so that logs
/// of long runs stay short.
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

class Progress {
 public:
  using Clock = ProgressLine::Clock;

  struct Work {
    std::int64_t total = 0;        ///< tasks of the plan
    std::int64_t done_before = 0;  ///< in earlier runs
    std::int64_t failed_before = 0;
    double cost = 0;  ///< of the tasks left
    int workers = 1;
  };

  Progress(Console& console, const Work& work, Clock::time_point now);

  void finished(TaskOutcome outcome, double cost, double busy_s);
  void uncount(TaskOutcome outcome, double cost, double busy_s);  ///< a finished task whose results were lost
  void show(Clock::time_point now);                               ///< prints if due; cheap
  void clear() { line_.clear(); }                                 ///< removes the bar

  /// "120 of 400 tasks (30 %), 2 failed, 31.0/s, 1 min 20 s left"
  std::string text(Clock::time_point now) const;
  /// Empty until a task has finished, or when overdue.
  std::optional<double> seconds_left(Clock::time_point now) const;

 private:
  ProgressLine line_;
  Work work_;
  std::int64_t done_ = 0, failed_ = 0;  ///< in this run
  double done_cost_ = 0, busy_s_ = 0;
  double pace_ = 0;  ///< s
  Clock::time_point begin_;
};

}  // namespace rodsweep
