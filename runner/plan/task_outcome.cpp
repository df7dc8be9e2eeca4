#include "runner/plan/task_outcome.hpp"

#include <algorithm>
#include <array>

namespace rodsweep {
namespace {

/// By value.
constexpr std::array<const char*, task_outcomes> outcome_names{
    "pending",         "ok",        "diverged", "not_a_number", "indefinite",
    "iteration_limit", "timed_out", "error",    "torn",         "crashed"};

}  // namespace

const char* to_string(TaskOutcome outcome) { return outcome_names.at(static_cast<std::size_t>(outcome)); }

std::optional<TaskOutcome> outcome_called(const std::string& name) {
  const auto found = std::find(outcome_names.begin(), outcome_names.end(), name);
  if (found == outcome_names.end()) return std::nullopt;
  return static_cast<TaskOutcome>(found - outcome_names.begin());
}

bool may_change(TaskOutcome outcome) {
  return outcome == TaskOutcome::pending || outcome == TaskOutcome::timed_out || outcome == TaskOutcome::error ||
         outcome == TaskOutcome::crashed;
}

}  // namespace rodsweep
