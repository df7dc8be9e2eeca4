// Decides which tasks may start before the time limit of a run, and which ones never fit into it.
//
// Expected time = cost x pace, with the pace measured on finished tasks of this and earlier starts. For tasks that cost
// at least as much as an abandoned one, the pace includes the completed shares of abandoned tasks. (The first steps of
// a long task say little about short tasks.)
// Costs are estimates. A task may start if its expected time is below 2/3 of the time left. If more than 90 % of the
// limit is left, up to 150 % of the whole limit is allowed: a later start won't have more time.
// A task that was abandoned after at least 90 % of the whole limit never fits.
#pragma once

#include <chrono>
#include <limits>

#include "runner/dispatch/pending_task.hpp"

namespace rodsweep {

class TimeBudget {
 public:
  using Seconds = std::chrono::duration<double>;
  static constexpr Seconds unlimited{std::numeric_limits<double>::infinity()};

  TimeBudget() = default;
  /// `left`: time left in this start; `whole`: the full limit.
  TimeBudget(Seconds left, Seconds whole) : left_(left), whole_(whole) {}

  /// Adds a finished task.
  void learn(double cost, Seconds took);
  /// Adds an abandoned task of which `share` was completed in `took`.
  void learn_part(double cost, double share, Seconds took);

  bool is_over(Seconds since_begin) const { return since_begin > left_; }
  bool fits(const PendingTask& task, Seconds since_begin) const;
  /// Whether the task fits into a start with the whole limit.
  bool ever_fits(const PendingTask& task) const;
  Seconds expected(const PendingTask& task) const;
  Seconds whole() const { return whole_; }

 private:
  struct Pace {
    Seconds took{0};
    double cost = 0;
  };

  Seconds left_ = unlimited, whole_ = unlimited;
  Pace whole_tasks_, parts_;
  double least_given_up_ = std::numeric_limits<double>::infinity();  ///< least cost of abandoned tasks
};

}  // namespace rodsweep
