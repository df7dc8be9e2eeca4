// Which tasks may still be begun before a start's time limit, and which ones never could be.
//
// A task is expected to take what its cost says at the pace of the tasks known so far: of those that ended, in this
// start or an earlier one, and for a task that costs no less than one that was given up, also of those, by the share of
// their steps that was done (the first steps of a long task say little of a short one). Costs are estimates: of what is
// left of the limit a task may take two thirds. While the limit has hardly begun (nine tenths are left) there will
// never be more of it, and half as much again as there is may be expected. A task that had a whole limit, but for a
// tenth, and was not done, is not begun again under such a limit.
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
  /// `left`: of this start; `whole`: of one that begins with the limit.
  TimeBudget(Seconds left, Seconds whole) : left_(left), whole_(whole) {}

  /// A task of that cost took so long.
  void learn(double cost, Seconds took);
  /// That share of it took so long, and it was given up.
  void learn_part(double cost, double share, Seconds took);

  bool is_over(Seconds since_begin) const { return since_begin > left_; }
  bool fits(const PendingTask& task, Seconds since_begin) const;
  /// In a start that has the whole limit.
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
  double least_given_up_ = std::numeric_limits<double>::infinity();  ///< cost
};

}  // namespace rodsweep
