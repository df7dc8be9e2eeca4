// Checks a job before a run: its input files, and whether its guesses, networks and factors fit its tasks.
#pragma once

#include "runner/job/job.hpp"
#include "runner/plan/plan.hpp"
#include "solver/factor/elimination_plan.hpp"

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

/// Throws JobError with the key, or FileError for a file that is not a model, unless guesses, and networks that replace the
/// solve, fit the job's rods and models. Nearest neighbours compare rods by arc length, so they need rods without loops
/// and branches. Several corrections, lag_steps and stop_at need a model with factors. A model of the encoding "state"
/// works only with state_network.
void check_guesses(const Plan& plan);

/// Throws JobError, with the memory needed and an alternative that needs no factor, if a factorisation would exceed its
/// memory limit (solver/factor/elimination_plan.hpp). Only rods with thousands of joints can exceed it, that have loops or
/// very many joints on one segment. Each size of such rods in a job is checked once, in about a second per 100,000 joints.
void check_factors(const Plan& plan, double most_bytes = most_factor_bytes);

}  // namespace rodsweep
