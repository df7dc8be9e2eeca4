// From the values of a job at one parameter point to the solver's types. Values have been checked; what depends on
// several of them together is checked here. Throws JobError.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runner/job/job.hpp"
#include "runner/job/sweep_space.hpp"
#include "runner/job/task.hpp"

namespace rodsweep {

TimeSpec time_spec(const Point& point, const Job& job);
SolveSpec solve_spec(const Point& point, const Job& job);  ///< the direct solve where the job says nothing: a data set
Evaluation evaluation(const Point& point);                 ///< paired where the job says nothing
RecordSpec record_spec(const Job& job);
std::vector<GuessSpec> guess_specs(const Point& point, const Job& job);

/// Labels of the job's guesses, in order.
std::vector<std::string> guess_labels(const Job& job);

/// Refuses a method that advances trajectories of its own where they are to be shared.
void check_method(const Point& point, const Job& job);

}  // namespace rodsweep
