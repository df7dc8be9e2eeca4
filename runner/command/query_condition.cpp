#include "runner/command/query_condition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "runner/job/key.hpp"
#include "runner/job/nearest.hpp"
#include "runner/job/task_outcome.hpp"

namespace rodsweep {
namespace {

using Operator = Condition::Operator;

constexpr double rounding = 1e-9;

// The longer ones first.
constexpr std::array<std::pair<const char*, Operator>, 8> operators{{{"<=", Operator::at_most},
                                                                     {">=", Operator::at_least},
                                                                     {"!=", Operator::not_equal},
                                                                     {"==", Operator::equal},
                                                                     {"=", Operator::equal},
                                                                     {"<", Operator::less},
                                                                     {">", Operator::more},
                                                                     {"~", Operator::contains}}};

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' '), last = text.find_last_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

FileError no_condition(const std::string& text) {
  return FileError(
      fmt::format("\"{}\" is no condition: write COLUMN=VALUE, or with one of != < <= > >= ~ (~: contains)", text));
}

struct Parts {
  std::string name, value;
  Operator comparison;
};

/// Parts at the operator that begins at `at`, if one does.
bool split(const std::string& text, std::size_t at, Parts& parts) {
  for (const auto& [symbol, comparison] : operators) {
    const std::string word = symbol;
    if (text.compare(at, word.size(), word) != 0) continue;
    parts = {trimmed(text.substr(0, at)), trimmed(text.substr(at + word.size())), comparison};
    return true;
  }
  return false;
}

/// Labels of guesses may hold any character: the operator is the first one that follows a column's name.
Parts parts_of(const std::string& text, const TaskTable& table) {
  Parts first, parts;
  bool any = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (!split(text, at, parts)) continue;
    if (table.find(parts.name)) return parts;
    if (!std::exchange(any, true)) first = parts;
  }
  if (!any || first.name.empty()) throw no_condition(text);
  return first;
}

/// What stands between commas outside of parentheses: labels may hold their own.
std::vector<std::string> listed(const std::string& text) {
  std::vector<std::string> items;
  std::size_t begin = 0;
  int depth = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    depth += (text[at] == '(') - (text[at] == ')');
    if (text[at] != ',' || depth != 0) continue;
    items.push_back(trimmed(text.substr(begin, at - begin)));
    begin = at + 1;
  }
  items.push_back(trimmed(text.substr(begin)));
  return items;
}

/// All values that the column can have, where that is known; else none.
std::vector<std::string> words_of(const TaskColumn& column, const TaskTable& table) {
  if (column.kind == TaskColumn::Kind::state) return {"done", "pending"};
  if (column.kind == TaskColumn::Kind::own_guess) return table.guesses();
  std::vector<std::string> words;
  if (column.kind == TaskColumn::Kind::outcome)
    for (int i = 0; i < task_outcomes; ++i) words.emplace_back(to_string(static_cast<TaskOutcome>(i)));
  return words;
}

double number(const std::string& text, const std::string& condition, const TaskColumn& column) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const bool decimal = !text.empty() && text.find_first_of("xX") == std::string::npos;
  if (!decimal || *end != '\0' || std::isnan(value))
    throw FileError(fmt::format("\"{}\": {} holds numbers, and \"{}\" is none", condition, column.name, text));
  return value;
}

/// A number, or LOW:HIGH, LOW: or :HIGH.
Condition::Range range(const std::string& text, const std::string& condition, const TaskColumn& column) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    const double value = number(text, condition, column);
    return {value, value};
  }
  const std::string low = trimmed(text.substr(0, colon)), high = trimmed(text.substr(colon + 1));
  if (low.empty() && high.empty())
    throw FileError(fmt::format("\"{}\": a range has one end at least: LOW:HIGH, LOW: or :HIGH", condition));
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Condition::Range ends{low.empty() ? -infinity : number(low, condition, column),
                              high.empty() ? infinity : number(high, condition, column)};
  if (ends.low > ends.high)
    throw FileError(fmt::format("\"{}\": nothing is in the range {}; write its lower end first", condition, text));
  return ends;
}

/// Of the infinite, which are no distance from each other, only what is equal.
bool same(double a, double b) {
  return a == b || (std::isfinite(a - b) && std::abs(a - b) <= rounding * std::max(std::abs(a), std::abs(b)));
}

bool compare(Operator comparison, double a, double b) {
  switch (comparison) {
    case Operator::less: return a < b && !same(a, b);
    case Operator::at_most: return a < b || same(a, b);
    case Operator::more: return a > b && !same(a, b);
    default: return a > b || same(a, b);
  }
}

}  // namespace

Condition parse_condition(const std::string& text, const TaskTable& table) {
  const Parts parts = parts_of(text, table);
  if (parts.value.empty()) throw no_condition(text);
  Condition condition;
  condition.column = table.column(parts.name);
  condition.comparison = parts.comparison;
  const bool equality = parts.comparison == Operator::equal || parts.comparison == Operator::not_equal;
  if (condition.column.is_number()) {
    if (parts.comparison == Operator::contains)
      throw FileError(fmt::format("\"{}\": {} holds numbers; ~ is for texts", text, parts.name));
    if (equality)
      for (const std::string& item : listed(parts.value))
        condition.ranges.push_back(range(item, text, condition.column));
    else
      condition.limit = number(parts.value, text, condition.column);
    return condition;
  }
  if (!equality && parts.comparison != Operator::contains)
    throw FileError(fmt::format("\"{}\": {} holds texts, which have no order; use =, != or ~", text, parts.name));
  const std::vector<std::string> words = words_of(condition.column, table);
  const auto known = [&](const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  if (!equality || known(parts.value)) {
    condition.texts = {parts.value};
    return condition;
  }
  condition.texts = listed(parts.value);
  for (const std::string& item : condition.texts)
    if (!words.empty() && !known(item))
      throw FileError(fmt::format(
          "\"{}\": {} is never \"{}\"{}", text, parts.name, item,
          did_you_mean(item, words).empty() ? "; it is one of " + quoted_list(words) : did_you_mean(item, words)));
  condition.texts.push_back(parts.value);  // a value that holds a comma
  return condition;
}

bool Condition::met(const ColumnValues& values, std::size_t task) const {
  if (column.is_number()) {
    const double value = values.numbers[task];
    if (std::isnan(value)) return false;
    if (comparison != Operator::equal && comparison != Operator::not_equal) return compare(comparison, value, limit);
    const bool found = std::any_of(ranges.begin(), ranges.end(), [&](const Range& wanted) {
      return compare(Operator::at_least, value, wanted.low) && compare(Operator::at_most, value, wanted.high);
    });
    return found == (comparison == Operator::equal);
  }
  const std::string& value = values.texts[task];
  if (value.empty()) return false;
  if (comparison == Operator::contains) return value.find(texts.front()) != std::string::npos;
  const bool found = std::find(texts.begin(), texts.end(), value) != texts.end();
  return found == (comparison == Operator::equal);
}

}  // namespace rodsweep
