// Checks a job before a run: its input files and its plan.
#pragma once

#include "runner/job/job.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

/// Opens each file of the job, except accepted missing ones, as each kind of file that its keys expect. Throws JobError
/// with the key and the reason.
void check_inputs(const Job& job);

/// Starts Python in this process and executes the job's files of Python, as check_inputs() does, so that the first task of
/// a worker takes as long as any other. Throws PluginError.
void load_python(const Job& job);

/// The plan of a sweep or data set whose input files exist, with every check that a run makes before its first task.
/// Throws JobError or FileError.
Plan checked_plan(const Job& job);

}  // namespace rodsweep
