// How `rodsweep query` writes rows: an aligned table (numbers to six digits, "-" for what is not there), CSV (RFC 4180,
// every digit, nothing for what is not there) or JSON (a list of objects, null). Rows are written as they are made, so
// that no more than the columns themselves is held.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "runner/command/query_command.hpp"
#include "runner/file/task_table.hpp"

namespace rodsweep {

struct ShownColumn {
  TaskColumn column;
  const ColumnValues* values;
};

/// `write` takes the text in pieces, in order.
void write_tasks(QueryOptions::Format format, const std::vector<ShownColumn>& columns,
                 const std::vector<std::int64_t>& tasks, const std::function<void(std::string_view)>& write);

}  // namespace rodsweep
