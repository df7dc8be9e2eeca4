#include "runner/file/record.hpp"

#include <algorithm>
#include <numeric>
#include <type_traits>

#include "runner/job/plan.hpp"

namespace rodsweep {

std::int64_t AxisSizes::size(Axis axis) const {
  switch (axis) {
    case Axis::guess: return guesses;
    case Axis::tolerance: return tolerances;
    case Axis::xyz: return 3;
    case Axis::wxyz: return 4;
    case Axis::constraint: return 6;
    case Axis::frame: return frames;
  }
  return 0;
}

AxisSizes axis_sizes(const Plan& plan) {
  return {static_cast<std::int64_t>(plan.guess_labels().size()), static_cast<std::int64_t>(tolerance_ladder().size()),
          plan.max_frames()};
}

std::int64_t row_width(const Column& column, const AxisSizes& sizes) {
  return std::accumulate(column.axes.begin(), column.axes.end(), std::int64_t{1},
                         [&](std::int64_t width, Axis axis) { return width * sizes.size(axis); });
}

void TaskRecord::prepare(const Task& task, const AxisSizes& sizes) {
  outcome = TaskOutcome::pending;
  message.clear();
  visit_columns(*this, [&](const Column& column, auto& values) {
    using T = typename std::decay_t<decltype(values)>::value_type;
    constexpr T sentinel = std::is_floating_point_v<T> ? std::numeric_limits<T>::quiet_NaN() : static_cast<T>(-1);
    values.assign(static_cast<std::size_t>(task.rows[column.rows].count * row_width(column, sizes)), sentinel);
  });
  std::fill(reason.begin(), reason.end(), static_cast<std::int8_t>(SolveOutcome::not_run));
}

}  // namespace rodsweep
