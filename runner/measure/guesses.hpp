// Constructs an initial guess from its spec.
#pragma once

#include <memory>

#include "runner/specs/task_spec.hpp"
#include "solver/guess/initial_guess.hpp"

namespace rodsweep {

std::unique_ptr<InitialGuess> make_guess(const GuessSpec& guess, const TaskSpec& task, const Scene& scene);

}  // namespace rodsweep
