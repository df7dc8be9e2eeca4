#include "runner/file/record.hpp"

#include <limits>
#include <type_traits>

#include "runner/file/columns.hpp"
#include "runner/file/layout.hpp"
#include "runner/plan/plan.hpp"
#include "runner/text/checksum.hpp"
#include "solver/linear/interruption.hpp"

namespace rodsweep {

AxisSizes axis_sizes(const Plan& plan) {
  return {static_cast<std::int64_t>(plan.guess_labels().size()), static_cast<std::int64_t>(tolerance_ladder().size()),
          plan.max_frames()};
}

void TaskRecord::prepare(const Task& task, const AxisSizes& sizes) {
  outcome = TaskOutcome::pending;
  message.clear();
  constexpr double ns_per_byte = 0.4;
  for (const Column& column : columns()) {
    std::visit(
        [&](auto* values) {
          using T = typename std::decay_t<decltype(*values)>::value_type;
          constexpr T sentinel = std::is_floating_point_v<T> ? std::numeric_limits<T>::quiet_NaN() : static_cast<T>(-1);
          values->reset(task.rows[column.rows].count, row_extent(column, sizes), sentinel);
        },
        column.values(*this));
    check_interrupted(static_cast<std::int64_t>(ns_per_byte * static_cast<double>(bytes_of(column, *this).size())));
  }
  std::fill(solves.outcome.begin(), solves.outcome.end(), static_cast<std::int8_t>(SolveOutcome::not_run));
}

PerRows<std::int64_t> row_bytes(const AxisSizes& sizes) {
  TaskRecord any;
  PerRows<std::int64_t> bytes{};
  for (const Column& column : columns()) {
    const auto one = std::visit([](auto* values) { return sizeof(*values->data()); }, column.values(any));
    bytes[column.rows] += row_width(column, sizes) * static_cast<std::int64_t>(one);
  }
  return bytes;
}

std::int64_t record_bytes(const Task& task, const PerRows<std::int64_t>& of_a_row) {
  std::int64_t bytes = 0;
  for (std::size_t kind = 0; kind < row_kinds; ++kind) bytes += task.rows[kind].count * of_a_row[kind];
  return bytes;
}

std::uint64_t task_checksum(std::int64_t task, const TaskRecord& record) {
  Checksum sum;
  const auto add = [&](std::string_view bytes) { sum.add(bytes.data(), bytes.size()); };
  sum.add(&task, sizeof task);
  add(hdf5::fixed_text(to_string(record.outcome), outcome_bytes));
  add(hdf5::fixed_text(record.message, message_bytes));
  for (const Column& column : columns()) {
    const std::string_view bytes = bytes_of(column, record);
    if (!is_timing(column) && !(is_optional(column.rows) && bytes.empty())) add(bytes);
  }
  return sum.value();
}

}  // namespace rodsweep
