// How a task ended. Failure is data: it is stored in the results file as the task's outcome.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace rodsweep {

/// Stored in files (/tasks/outcome) by name.
enum class TaskOutcome : std::int8_t {
  pending = 0,          ///< not run yet
  ok = 1,               ///< all steps completed
  diverged = 2,         ///< the simulation blew up (joints open by a hundred lengths) or a solve diverged
  not_a_number = 3,     ///< the state holds a NaN or infinity
  indefinite = 4,       ///< the system matrix or the preconditioner is not positive definite
  iteration_limit = 5,  ///< the solve that advances the trajectory reached its iteration limit
  timed_out = 6,        ///< the task exceeded its time limit
  error = 7,            ///< an exception; its text is the task's message
  torn = 8,             ///< a joint opened by more than its length or, while clamps move, turned past half a turn
  crashed = 9,          ///< its worker died while running it, `--max-crashes` times
};
inline constexpr int task_outcomes = 10;

const char* to_string(TaskOutcome outcome);

/// The outcome with this name, if any.
std::optional<TaskOutcome> outcome_called(const std::string& name);

/// Whether another try, on another host or with more time or memory, may end differently.
bool may_change(TaskOutcome outcome);

}  // namespace rodsweep
