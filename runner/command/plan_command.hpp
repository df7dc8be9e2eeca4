// The commands `plan` and `validate`: what a job would do. Throws JobError. Neither needs MPI; a plan with probes needs
// PETSc.
#pragma once

#include "runner/command/command_line.hpp"
#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

ExitCode show_plan(const PlanOptions& options, Console& console);

/// Says of every job whether it is sound, and goes on after one that is not.
ExitCode validate_jobs(const ValidateOptions& options, Console& console);

}  // namespace rodsweep
