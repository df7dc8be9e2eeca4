// The columns of /tasks with each task's parameters.
#include <algorithm>
#include <limits>

#include "runner/job/job_keys.hpp"
#include "runner/job/option_label.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {
namespace {

using State = Point::Value::State;

const Key& steps_key() { return *find_key(find_key(job_key().keys, "time")->keys, "steps"); }

ParameterColumn empty_column(const std::string& path, const Key& key, std::size_t tasks) {
  ParameterColumn column;
  column.path = path;
  column.unit = key.unit;
  column.meaning = key.help;
  if (key.kind == Key::Kind::number && !key.choices.empty()) column.meaning += "; NaN: " + quoted_list(key.choices);
  if (key.kind == Key::Kind::boolean) column.meaning += "; 1: true";
  column.width = key.kind == Key::Kind::vector ? 3 : 1;
  if (key.kind == Key::Kind::integer || key.kind == Key::Kind::boolean) {
    column.values = std::vector<std::int64_t>(tasks, -1);
  } else if (key.kind == Key::Kind::number || key.kind == Key::Kind::vector) {
    const auto width = static_cast<std::size_t>(column.width);
    column.values = std::vector<double>(tasks * width, std::numeric_limits<double>::quiet_NaN());
  } else {
    column.values = std::vector<std::string>(tasks);
  }
  return column;
}

bool equal(const Point::Value& a, const Point::Value& b) {
  if (a.state != b.state) return false;
  return a.state == State::text ? *a.text == *b.text : std::equal(a.number, a.number + 3, b.number);
}

bool is_of_guess(const ParameterColumn& column) { return column.path.rfind("guesses[", 0) == 0; }

void put(ParameterColumn& column, std::size_t task, const Point::Value& value) {
  if (auto* integers = std::get_if<std::vector<std::int64_t>>(&column.values)) {
    (*integers)[task] = static_cast<std::int64_t>(value.number[0]);
  } else if (auto* texts = std::get_if<std::vector<std::string>>(&column.values)) {
    (*texts)[task] = *value.text;
  } else if (value.state == State::number) {  // a word in a numeric column stays NaN
    const auto width = static_cast<std::size_t>(column.width);
    auto& numbers = std::get<std::vector<double>>(column.values);
    std::copy_n(value.number, width, numbers.begin() + static_cast<std::ptrdiff_t>(task * width));
  }
}

}  // namespace

std::vector<ParameterColumn> Plan::parameters() const {
  const std::vector<Parameter>& parameters = space_.parameters();
  const auto task_count = static_cast<std::size_t>(size());
  std::vector<ParameterColumn> columns;
  for (const Parameter& parameter : parameters) {
    columns.push_back(empty_column(parameter.path, parameter.key, task_count));
  }
  std::vector<Point::Value> first(parameters.size());
  Point point;
  std::int64_t filled = -1;
  for (const Task& task : tasks_) {
    if (filled != task.point) fill(point, filled = task.point);
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const Point::Value& value = point[i];
      if (value.state == State::absent) continue;
      put(columns[i], static_cast<std::size_t>(task.index), value);
      if (first[i].state == State::absent) first[i] = value;
      columns[i].swept = columns[i].swept || !equal(first[i], value);
    }
  }

  // Every job has `steps`, also if it has a duration instead.
  auto steps = std::find_if(columns.begin(), columns.end(), [](const auto& c) { return c.path == "time.steps"; });
  if (steps == columns.end())
    steps = columns.insert(columns.end(), empty_column("time.steps", steps_key(), task_count));
  auto& step_counts = std::get<std::vector<std::int64_t>>(steps->values);
  for (const Task& task : tasks_) {
    step_counts[static_cast<std::size_t>(task.index)] = task.steps;
    steps->swept = steps->swept || task.steps != step_counts.front();
  }

  // A constant guess is described by its label, and a key that contains others by the columns of these. A varying guess
  // keeps all parameters, also constant ones, because they describe the guess in the tasks to which they apply.
  const auto is_option = [&](const ParameterColumn& c) {
    const int parameter = space_.find(c.path);
    return parameter >= 0 && has_option_label(parameters[static_cast<std::size_t>(parameter)].key);
  };
  std::vector<std::string> varying;
  for (const ParameterColumn& c : columns)
    if (is_of_guess(c) && c.swept && std::holds_alternative<std::vector<std::string>>(c.values))
      varying.push_back(c.path + ".");
  const auto is_settled = [&](const ParameterColumn& c) {
    return (is_of_guess(c) || is_option(c)) && !c.swept &&
           std::find(kept_.begin(), kept_.end(), c.path) == kept_.end() &&
           std::none_of(varying.begin(), varying.end(),
                        [&](const std::string& guess) { return c.path.rfind(guess, 0) == 0; });
  };
  columns.erase(std::remove_if(columns.begin(), columns.end(), is_settled), columns.end());
  return columns;
}

}  // namespace rodsweep
