// Time steps, solves and what is written of them in a job: the keys of `time` and `solve`, and what is made of them at
// a parameter point. Values have been checked; what depends on several of them together is checked here. Throws
// JobError.
#pragma once

#include "runner/job/job.hpp"
#include "runner/job/key.hpp"
#include "runner/job/sweep_space.hpp"
#include "runner/job/task.hpp"

namespace rodsweep {

Key time_key();
Key solve_key();

TimeSpec time_spec(const Point& point, const Job& job);
SolveSpec solve_spec(const Point& point, const Job& job);  ///< the direct solve where the job says nothing: a data set
Evaluation evaluation(const Point& point);                 ///< paired where the job says nothing
OutputSpec output_spec(const Job& job);

/// Refuses a method that advances trajectories of its own where they are to be shared.
void check_method(const Point& point, const Job& job);

}  // namespace rodsweep
