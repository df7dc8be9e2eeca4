// What makes two tasks of two plans the same.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "runner/job/key_path.hpp"
#include "runner/job/plan.hpp"

namespace rodsweep {
namespace {

using State = Point::Value::State;

/// Numbers to the last bit; -0 is another one than 0.
std::string exactly(const Point::Value& value) {
  if (value.state == State::text) return *value.text;
  std::string bytes(sizeof value.number, '\0');
  std::memcpy(bytes.data(), value.number, bytes.size());
  return bytes;
}

}  // namespace

TaskIdentity Plan::identity(std::int64_t index) const {
  const Task& task = tasks_.at(static_cast<std::size_t>(index));
  const TaskSpec spec = this->spec(index);
  Point point;
  fill(point, task.point);
  std::vector<std::string> lines;
  std::vector<std::vector<std::string>> of_guesses(guess_labels_.size());
  const std::vector<Parameter>& parameters = space_.parameters();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (point[i].state == State::absent) continue;
    const std::string& path = parameters[i].path;
    if (path.rfind("guesses[", 0) != 0) {
      lines.push_back(path + " = " + exactly(point[i]));
      continue;
    }
    const std::size_t end = path.find(']');
    of_guesses.at(std::stoul(path.substr(8, end - 8))).push_back(path.substr(end + 1) + " = " + exactly(point[i]));
  }
  std::sort(lines.begin(), lines.end());

  TaskIdentity identity;
  for (auto& of_guess : of_guesses) {
    std::sort(of_guess.begin(), of_guess.end());
    identity.guesses.push_back(fmt::format("{}", fmt::join(of_guess, "\n")));
  }
  if (spec.guesses.empty()) identity.guesses.clear();
  identity.trajectory =
      fmt::format("{}\nseed = {}\nlimit = {:a}\nrecord = {} {}\n{}", fmt::join(lines, "\n"), spec.seed,
                  spec.time_limit_s, spec.record.solves, spec.record.trajectory_every,
                  spec.own_guess < 0 ? "" : "own guess" + identity.guesses[static_cast<std::size_t>(spec.own_guess)]);
  return identity;
}

}  // namespace rodsweep
