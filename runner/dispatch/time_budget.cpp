#include "runner/dispatch/time_budget.hpp"

#include <algorithm>

namespace rodsweep {
namespace {

constexpr double margin = 1.5;        // costs are estimates
constexpr double nearly_whole = 0.9;  // startup takes some of it

/// Lower bound of the task's time, capped by its own limit.
TimeBudget::Seconds tried(const PendingTask& task) { return TimeBudget::Seconds(std::min(task.tried_s, task.limit_s)); }

}  // namespace

void TimeBudget::learn(double cost, Seconds took) {
  if (!(cost > 0) || !(took.count() > 0)) return;
  whole_tasks_.took += took;
  whole_tasks_.cost += cost;
}

void TimeBudget::learn_part(double cost, double share, Seconds took) {
  if (!(cost * share > 0) || !(took.count() > 0)) return;
  parts_.took += took;
  parts_.cost += cost * share;
  least_given_up_ = std::min(least_given_up_, cost);
}

bool TimeBudget::fits(const PendingTask& task, Seconds since_begin) const {
  const Seconds left = left_ - since_begin;
  return margin * expected(task) < left || (left > nearly_whole * whole_ && ever_fits(task));
}

bool TimeBudget::ever_fits(const PendingTask& task) const {
  return tried(task) < nearly_whole * whole_ && expected(task) < margin * whole_;
}

TimeBudget::Seconds TimeBudget::expected(const PendingTask& task) const {
  Pace pace = whole_tasks_;
  if (task.cost >= least_given_up_) pace = {pace.took + parts_.took, pace.cost + parts_.cost};
  if (!(pace.cost > 0)) return tried(task);
  return std::clamp(pace.took * (task.cost / pace.cost), tried(task), Seconds(task.limit_s));
}

}  // namespace rodsweep
