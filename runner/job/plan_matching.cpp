#include "runner/job/plan_matching.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <unordered_map>

namespace rodsweep {
namespace {

/// Of a task of one of the plans: what makes it the same as another, and its guesses, likewise.
using Identify = std::function<TaskIdentity(std::int64_t task)>;

std::map<std::string, ParameterColumn> columns_of(const Plan& plan) {
  std::map<std::string, ParameterColumn> columns;
  for (ParameterColumn& column : plan.parameters()) {
    std::string path = column.path;
    if (path.rfind("guesses[", 0) == 0) {  // wherever it stands among the guesses
      const std::size_t end = path.find(']');
      path = "guess " + plan.guess_labels().at(std::stoul(path.substr(8, end - 8))) + path.substr(end + 1);
    }
    columns.emplace(std::move(path), std::move(column));
  }
  return columns;
}

std::set<std::string> swept(const std::map<std::string, ParameterColumn>& columns) {
  std::set<std::string> paths;
  for (const auto& [path, column] : columns)
    if (column.swept) paths.insert(path);
  return paths;
}

bool is_there(double value) { return !std::isnan(value); }
bool is_there(std::int64_t value) { return value != -1; }
bool is_there(const std::string& value) { return !value.empty(); }

/// Of one task, numbers to the last digit; "" where the key does not apply to it.
std::string value_text(const ParameterColumn& column, std::int64_t task) {
  std::string text;
  std::visit(
      [&](const auto& values) {
        for (std::int64_t i = task * column.width; i < (task + 1) * column.width; ++i)
          if (const auto& value = values[static_cast<std::size_t>(i)]; is_there(value))
            text += fmt::format("{} ", value);
      },
      column.values);
  return text;
}

Identify by_parameters(const Plan& plan, const std::map<std::string, ParameterColumn>& columns,
                       const std::set<std::string>& paths) {
  return [&plan, &columns, &paths](std::int64_t index) {
    const Task task = plan.task(index);
    TaskIdentity identity;
    identity.guesses = plan.guess_labels();
    identity.trajectory = fmt::format("sample {}\n", task.sample);
    if (task.own_guess >= 0) identity.trajectory += plan.guess_labels()[static_cast<std::size_t>(task.own_guess)];
    for (const auto& [path, column] : columns)
      if (const std::string value = paths.count(path) != 0 ? value_text(column, index) : ""; !value.empty())
        identity.trajectory += fmt::format("\n{} = {}", path, value);
    return identity;
  };
}

/// Places in `there` of the guesses of `here`, or -1. In a closed loop a task has its own guess alone.
std::vector<int> guess_places(const Task& task, const TaskIdentity& here, const Task& other,
                              const TaskIdentity& there) {
  std::vector<int> places(here.guesses.size(), -1);
  if (task.own_guess >= 0) {
    places[static_cast<std::size_t>(task.own_guess)] = other.own_guess;
    return places;
  }
  for (std::size_t g = 0; g < places.size(); ++g) {
    const auto found = std::find(there.guesses.begin(), there.guesses.end(), here.guesses[g]);
    if (found != there.guesses.end()) places[g] = static_cast<int>(found - there.guesses.begin());
  }
  return places;
}

PlanMatch match(const Plan& a, const Identify& of_a, const Plan& b, const Identify& of_b) {
  std::unordered_map<std::size_t, std::vector<std::int64_t>> candidates;
  const std::hash<std::string> hash;
  for (const Task& task : b.tasks()) candidates[hash(of_b(task.index).trajectory)].push_back(task.index);
  std::vector<bool> taken(static_cast<std::size_t>(b.size()), false);
  PlanMatch result;
  for (const Task& task : a.tasks()) {
    const TaskIdentity wanted = of_a(task.index);
    const auto same = candidates.find(hash(wanted.trajectory));
    TaskPair best{task.index, -1, {}};
    std::int64_t most = -1;
    for (const std::int64_t candidate : same == candidates.end() ? std::vector<std::int64_t>() : same->second) {
      if (taken[static_cast<std::size_t>(candidate)]) continue;
      const TaskIdentity found = of_b(candidate);
      if (found.trajectory != wanted.trajectory) continue;
      std::vector<int> places = guess_places(task, wanted, b.task(candidate), found);
      const auto shared = std::count_if(places.begin(), places.end(), [](int place) { return place >= 0; });
      if (shared > most) most = shared, best.b = candidate, best.guesses = std::move(places);
    }
    if (best.b < 0) {
      result.only_a.push_back(task.index);
      continue;
    }
    taken[static_cast<std::size_t>(best.b)] = true;
    result.pairs.push_back(std::move(best));
  }
  for (const Task& task : b.tasks())
    if (!taken[static_cast<std::size_t>(task.index)]) result.only_b.push_back(task.index);
  return result;
}

}  // namespace

PlanMatch match(const Plan& a, const Plan& b, MatchBy by) {
  if (by == MatchBy::everything)
    return match(
        a, [&](std::int64_t task) { return a.identity(task); }, b, [&](std::int64_t task) { return b.identity(task); });
  const std::map<std::string, ParameterColumn> columns_a = columns_of(a), columns_b = columns_of(b);
  std::set<std::string> paths = swept(columns_a);
  paths.merge(swept(columns_b));
  return match(a, by_parameters(a, columns_a, paths), b, by_parameters(b, columns_b, paths));
}

}  // namespace rodsweep
