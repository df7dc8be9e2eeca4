#include "runner/command/query_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "runner/command/query_condition.hpp"
#include "runner/command/query_output.hpp"

namespace rodsweep {
namespace {

/// Columns that were read, by name; each is read once.
class ColumnCache {
 public:
  explicit ColumnCache(const TaskTable& table) : table_(&table) {}

  const ColumnValues& operator[](const TaskColumn& column) {
    const auto found = values_.find(column.name);
    return found != values_.end() ? found->second : values_.emplace(column.name, table_->read(column)).first->second;
  }

 private:
  const TaskTable* table_;
  std::map<std::string, ColumnValues> values_;
};

/// Task number, what is swept, outcome, how deep bodies got into each other, and the CG ratios; in a closed loop whose
/// guess it is instead of those, since there a task has one guess alone.
std::vector<TaskColumn> usual_columns(const TaskTable& table) {
  std::vector<TaskColumn> columns{table.column("task")};
  for (const TaskColumn& column : table.columns())
    if (column.parameter && column.swept) columns.push_back(column);
  if (table.has_own_guesses()) columns.push_back(table.column("own_guess"));
  columns.push_back(table.column("outcome"));
  if (const auto found = table.find("penetration")) columns.push_back(*found);
  for (const char* name : {"steps_done", "elapsed_s"})
    if (const auto found = table.find(name); found && table.has_own_guesses()) columns.push_back(*found);
  for (const std::string& guess : table.guesses())
    if (const auto found = table.find("cg_ratio." + guess); found && guess != "zero" && !table.has_own_guesses())
      columns.push_back(*found);
  return columns;
}

/// Each entry is a name, which may hold commas, or a list of names.
std::vector<TaskColumn> chosen_columns(const TaskTable& table, const std::vector<std::string>& entries) {
  std::vector<TaskColumn> columns;
  for (const std::string& entry : entries) {
    if (const auto found = table.find(entry)) {
      columns.push_back(*found);
      continue;
    }
    for (std::size_t begin = 0, comma = 0; comma != std::string::npos; begin = comma + 1) {
      comma = entry.find(',', begin);
      columns.push_back(table.column(entry.substr(begin, comma - begin)));
    }
  }
  return columns;
}

std::string listed(const std::vector<std::string>& items) { return fmt::format("{}", fmt::join(items, ", ")); }

/// Every column with its meaning; those of the guesses once for all.
std::string columns_text(const TaskTable& table) {
  std::vector<std::pair<std::string, std::string>> lines;
  for (const TaskColumn& column : table.columns()) {
    if (!column.guess.empty() && column.guess != table.guesses().front()) continue;
    std::string name = column.name;
    if (!column.guess.empty()) name.replace(name.size() - column.guess.size(), std::string::npos, "GUESS");
    if (column.by_tolerance) name += "[@TOLERANCE]";
    lines.emplace_back(name, column.meaning + (column.unit.empty() ? "" : " [" + column.unit + "]"));
  }
  std::size_t width = 0;
  for (const auto& line : lines) width = std::max(width, line.first.size());
  std::string text;
  for (const auto& [name, meaning] : lines) text += fmt::format("{:{}}  {}\n", name, width, meaning);
  if (table.guesses().empty()) return text;
  std::vector<std::string> tolerances;
  for (const double tolerance : table.tolerances()) tolerances.push_back(tolerance_text(tolerance));
  return text + fmt::format("\nGUESS      {}\nTOLERANCE  {}; without one {}\n", listed(table.guesses()),
                            listed(tolerances), tolerance_text(table.headline()));
}

std::vector<std::int64_t> matching(const TaskTable& table, const std::vector<Condition>& conditions,
                                   ColumnCache& cache) {
  std::vector<std::int64_t> tasks(static_cast<std::size_t>(table.size()));
  std::iota(tasks.begin(), tasks.end(), 0);
  for (const Condition& condition : conditions) {
    const ColumnValues& values = cache[condition.column];
    const auto misses = [&](std::int64_t task) { return !condition.met(values, static_cast<std::size_t>(task)); };
    tasks.erase(std::remove_if(tasks.begin(), tasks.end(), misses), tasks.end());
  }
  return tasks;
}

/// What is not there comes last, in either direction.
void sort_tasks(std::vector<std::int64_t>& tasks, const TaskColumn& column, const ColumnValues& values,
                bool descending) {
  const auto before = [&](const auto& a, const auto& b, bool a_missing, bool b_missing) {
    if (a_missing || b_missing) return !a_missing && b_missing;
    return descending ? b < a : a < b;
  };
  std::stable_sort(tasks.begin(), tasks.end(), [&](std::int64_t left, std::int64_t right) {
    const auto l = static_cast<std::size_t>(left), r = static_cast<std::size_t>(right);
    if (!column.is_number()) {
      const std::string &a = values.texts[l], &b = values.texts[r];
      return before(a, b, a.empty(), b.empty());
    }
    const double a = values.numbers[l], b = values.numbers[r];
    return before(a, b, std::isnan(a), std::isnan(b));
  });
}

}  // namespace

ExitCode execute(const QueryOptions& options, Console& console) {
  const TaskTable table(options.file);
  if (options.columns == std::vector<std::string>{"help"}) {
    console.raw_result(columns_text(table));
    return ExitCode::ok;
  }
  // What is asked for is checked as a whole before anything is read.
  std::vector<Condition> conditions;
  for (const std::string& text : options.conditions) conditions.push_back(parse_condition(text, table));
  const std::vector<TaskColumn> columns =
      options.columns.empty() ? usual_columns(table) : chosen_columns(table, options.columns);
  const TaskColumn sort = table.column(options.sort.empty() ? "task" : options.sort);

  ColumnCache cache(table);
  std::vector<std::int64_t> tasks = matching(table, conditions, cache);
  const std::size_t found = tasks.size();
  sort_tasks(tasks, sort, cache[sort], options.descending);
  if (options.limit && static_cast<std::size_t>(*options.limit) < found)
    tasks.resize(static_cast<std::size_t>(*options.limit));

  std::vector<ShownColumn> shown;
  for (const TaskColumn& column : columns) shown.push_back({column, &cache[column]});
  write_tasks(options.format, shown, tasks, [&](std::string_view piece) { console.raw_result(piece); });
  if (options.format == QueryOptions::Format::table)
    console.note(fmt::format("{} of {} tasks{}", found, table.size(),
                             tasks.size() < found ? fmt::format(", {} of them shown", tasks.size()) : ""));
  return ExitCode::ok;
}

}  // namespace rodsweep
