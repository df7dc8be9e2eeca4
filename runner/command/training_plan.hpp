// The command `plan` for a job of kind "train": parameters, examples and steps. Throws JobError and FileError.
#pragma once

#include "runner/command/plan_command.hpp"
#include "runner/job/job.hpp"

namespace rodsweep {

ExitCode show_training_plan(const PlanOptions& options, const Job& job, Console& console);

}  // namespace rodsweep
