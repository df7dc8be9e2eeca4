// How a task ended. Failure is data: it reaches the user's file as the task's outcome.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace rodsweep {

/// Stored in files (/tasks/outcome) by name.
enum class TaskOutcome : std::int8_t {
  pending = 0,          ///< not run yet
  ok = 1,               ///< every step was taken
  diverged = 2,         ///< the simulation blew up (joints open by a hundred lengths) or a solve diverged
  not_a_number = 3,     ///< the state holds a NaN or infinity
  indefinite = 4,       ///< the system matrix lost positive definiteness
  iteration_limit = 5,  ///< the solve that advances the trajectory hit its cap on iterations
  timed_out = 6,        ///< the task's time limit passed
  error = 7,            ///< an exception; its text is the task's message
  torn = 8,             ///< a joint opened by more than its length: no rod any more
  crashed = 9,          ///< its worker ended while it ran, three times, and could not say why
};
inline constexpr int task_outcomes = 10;

const char* to_string(TaskOutcome outcome);

/// The outcome of that name; nothing of another.
std::optional<TaskOutcome> outcome_called(const std::string& name);

/// Whether another try, elsewhere or with more time or memory, may end otherwise.
bool may_change(TaskOutcome outcome);

}  // namespace rodsweep
