#include "runner/dispatch/time_budget.hpp"

#include <algorithm>

namespace rodsweep {
namespace {

constexpr double margin = 1.5;        // costs are estimates
constexpr double nearly_whole = 0.9;  // starting takes some of it

}  // namespace

void TimeBudget::learn(double cost, Seconds took) {
  if (!(cost > 0) || !(took.count() > 0)) return;
  known_ += took;
  known_cost_ += cost;
}

bool TimeBudget::fits(const PendingTask& task, Seconds since_begin) const {
  const Seconds left = left_ - since_begin;
  return margin * expected(task) < left || (left > nearly_whole * whole_ && ever_fits(task));
}

bool TimeBudget::ever_fits(const PendingTask& task) const {
  return Seconds(task.tried_s) < nearly_whole * whole_ && expected(task) < margin * whole_;
}

TimeBudget::Seconds TimeBudget::expected(const PendingTask& task) const {
  if (!(known_cost_ > 0)) return Seconds(task.tried_s);
  return std::clamp(known_ * (task.cost / known_cost_), Seconds(task.tried_s),
                    std::max(Seconds(task.tried_s), Seconds(task.limit_s)));
}

}  // namespace rodsweep
