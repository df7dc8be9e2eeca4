// The columns of /tasks with each task's parameters.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "runner/keys/key.hpp"
#include "runner/keys/sweep_words.hpp"
#include "runner/plan/plan.hpp"
#include "runner/specs/solve_keys.hpp"

namespace rodsweep {
namespace {

using State = Point::Value::State;

const Key& steps_key() { return *find_key(find_key(job_key().keys, "time")->keys, "steps"); }

ParameterColumn empty_column(const std::string& path, const Key& key) {
  ParameterColumn column;
  column.path = path;
  column.unit = key.unit;
  column.meaning = key.help;
  if (key.kind == Key::Kind::number && !key.choices.empty()) column.meaning += "; NaN: " + quoted_list(key.choices);
  if (key.kind == Key::Kind::boolean) column.meaning += "; 1: true";
  column.width = key.kind == Key::Kind::vector ? 3 : 1;
  if (key.kind == Key::Kind::integer || key.kind == Key::Kind::boolean)
    column.values = ColumnValues<std::int64_t>();
  else if (key.kind == Key::Kind::number || key.kind == Key::Kind::vector)
    column.values = ColumnValues<double>(static_cast<std::size_t>(column.width));
  else
    column.values = ColumnValues<std::string>();
  return column;
}

bool equal(const Point::Value& a, const Point::Value& b) {
  if (a.state != b.state) return false;
  return a.state == State::text ? *a.text == *b.text : std::equal(a.number, a.number + 3, b.number);
}

bool is_of_guess(const ParameterColumn& column) { return column.path.rfind("guesses[", 0) == 0; }

void append(ParameterColumn& column, const Point::Value& value) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double no_numbers[3] = {nan, nan, nan};
  static const std::string no_text;
  if (auto* integers = std::get_if<ColumnValues<std::int64_t>>(&column.values)) {
    const std::int64_t integer = value.state == State::absent ? -1 : static_cast<std::int64_t>(value.number[0]);
    integers->append(&integer);
  } else if (auto* texts = std::get_if<ColumnValues<std::string>>(&column.values)) {
    texts->append(value.state == State::absent ? &no_text : value.text);
  } else {  // a word in a numeric column is NaN
    std::get<ColumnValues<double>>(column.values).append(value.state == State::number ? value.number : no_numbers);
  }
}

using State = Point::Value::State;

constexpr std::string_view guesses = "guesses[";

/// Appends a parameter and its value: numbers bit by bit (-0 differs from 0), files by their content hash.
void append(std::string& text, std::string_view path, const Point::Value& value, const Parameter& parameter,
            const Job& job) {
  text += path;
  text += " = ";
  if (parameter.key.text == Key::Text::path) {
    text += job.files.at(*value.text).hash;
  } else if (value.state == State::text) {
    text += *value.text;
  } else {
    text.append(reinterpret_cast<const char*>(value.number), sizeof value.number);
  }
  text += '\n';
}

}  // namespace

std::vector<ParameterColumn> Plan::parameters() const {
  const std::vector<Parameter>& parameters = space_.parameters();
  std::vector<ParameterColumn> columns;
  for (const Parameter& parameter : parameters) columns.push_back(empty_column(parameter.path, parameter.key));
  // Every job has `steps`, also if it has a duration instead.
  ParameterColumn steps = empty_column("time.steps", steps_key());
  std::vector<Point::Value> first(parameters.size());
  Point point;
  std::int64_t filled = -1;
  for (const Task& task : tasks_) {
    if (filled != task.point) fill(point, filled = task.point);
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const Point::Value& value = point[i];
      append(columns[i], value);
      if (value.state == State::absent) continue;
      if (first[i].state == State::absent) first[i] = value;
      columns[i].swept = columns[i].swept || !equal(first[i], value);
    }
    const std::int64_t count = task.steps;
    std::get<ColumnValues<std::int64_t>>(steps.values).append(&count);
  }
  steps.swept = std::get<ColumnValues<std::int64_t>>(steps.values).distinct().size() > 1;
  const auto given = std::find_if(columns.begin(), columns.end(), [&](const auto& c) { return c.path == steps.path; });
  if (given == columns.end())
    columns.push_back(std::move(steps));
  else
    *given = std::move(steps);

  // A constant guess is described by its label, and a key that contains others by the columns of these. A varying guess
  // keeps all parameters, also constant ones, because they describe the guess in the tasks to which they apply.
  const auto is_option = [&](const ParameterColumn& c) {
    const int parameter = space_.find(c.path);
    return parameter >= 0 && has_option_label(parameters[static_cast<std::size_t>(parameter)].key);
  };
  std::vector<std::string> varying;
  for (const ParameterColumn& c : columns)
    if (is_of_guess(c) && c.swept && std::holds_alternative<ColumnValues<std::string>>(c.values))
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

// All inputs of a task's results, equal in all plans with this task.

TaskInputs Plan::inputs(std::int64_t index) const {
  const Task task = tasks_.at(index);
  Point point;
  fill(point, task.point);
  TaskInputs inputs;
  const bool tries_guesses = solve_spec(point, job_).method == Method::cg;
  if (tries_guesses) inputs.guesses.resize(guess_labels_.size());
  std::map<std::string, std::size_t> by_path;
  for (std::size_t i = 0; i < space_.parameters().size(); ++i) by_path[space_.parameters()[i].path] = i;
  for (const auto& [path, parameter] : by_path) {
    const Point::Value& value = point[parameter];
    const Parameter& described = space_.parameters()[parameter];
    if (value.state == State::absent || has_option_label(described.key)) continue;
    if (path.rfind(guesses, 0) != 0) {
      append(inputs.trajectory, path, value, described, job_);
    } else if (tries_guesses) {
      const std::size_t end = path.find(']');
      const auto guess = std::stoul(path.substr(guesses.size(), end - guesses.size()));
      append(inputs.guesses.at(guess), std::string_view(path).substr(end + 1), value, described, job_);
    }
  }
  inputs.trajectory += fmt::format("seed {} sample {}\n", job_.seed, task.sample);
  if (task.own_guess >= 0) {
    inputs.trajectory += inputs.guesses.at(static_cast<std::size_t>(task.own_guess));
    inputs.guesses.clear();
  }
  inputs.record = job_.values["record"].dump();
  return inputs;
}

}  // namespace rodsweep
