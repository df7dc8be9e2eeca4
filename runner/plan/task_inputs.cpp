// All inputs of a task's results, equal in all plans with this task.
#include <fmt/format.h>

#include "runner/keys/option_label.hpp"
#include "runner/plan/plan.hpp"
#include "runner/specs/solve_keys.hpp"

namespace rodsweep {
namespace {

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
