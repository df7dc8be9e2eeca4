#include "runner/file/task_checksum.hpp"

#include "runner/file/columns.hpp"
#include "runner/file/layout.hpp"
#include "runner/text/checksum.hpp"

namespace rodsweep {

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
