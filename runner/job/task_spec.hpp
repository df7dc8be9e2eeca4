// The keys of `time` and `solve` in a job, and the specs constructed from them at a parameter point. Single values
// are already validated; conditions on several values are checked here. Throws JobError.
#pragma once

#include "runner/job/job.hpp"
#include "runner/job/key.hpp"
#include "runner/job/sweep_space.hpp"
#include "runner/job/task.hpp"

namespace rodsweep {

Key time_key();
Key solve_key();

TimeSpec time_spec(const Point& point, const Job& job);
SolveSpec solve_spec(const Point& point, const Job& job);  ///< default: the direct solve (data sets)
Evaluation evaluation(const Point& point);                 ///< default: paired
OutputSpec output_spec(const Job& job);

/// Throws JobError if the solve method conflicts with other settings, such as a paired evaluation.
void check_method(const Point& point, const Job& job);

}  // namespace rodsweep
