#include "runner/plan/task_outcome.hpp"

namespace rodsweep {

const char* to_string(TaskOutcome outcome) {
  switch (outcome) {
    case TaskOutcome::pending: return "pending";
    case TaskOutcome::ok: return "ok";
    case TaskOutcome::diverged: return "diverged";
    case TaskOutcome::not_a_number: return "not_a_number";
    case TaskOutcome::indefinite: return "indefinite";
    case TaskOutcome::iteration_limit: return "iteration_limit";
    case TaskOutcome::timed_out: return "timed_out";
    case TaskOutcome::error: return "error";
    case TaskOutcome::torn: return "torn";
    case TaskOutcome::crashed: return "crashed";
  }
  return "unknown";
}

std::optional<TaskOutcome> outcome_called(const std::string& name) {
  for (int i = 0; i < task_outcomes; ++i)
    if (name == to_string(static_cast<TaskOutcome>(i))) return static_cast<TaskOutcome>(i);
  return std::nullopt;
}

bool may_change(TaskOutcome outcome) {
  switch (outcome) {
    case TaskOutcome::pending:
    case TaskOutcome::timed_out:
    case TaskOutcome::error:
    case TaskOutcome::crashed: return true;
    default: return false;
  }
}

}  // namespace rodsweep
