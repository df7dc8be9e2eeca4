// The plan of a results file, made again from the job that the file holds.
#pragma once

#include <filesystem>

#include "runner/file/inspect.hpp"
#include "runner/job/plan.hpp"

namespace rodsweep {

/// The job file as the last start found it, where relative paths in the job begin; the results file where none says.
std::filesystem::path stored_job_path(const FileSummary& file);

/// Throws FileError for a job that this version does not accept.
Plan stored_plan(const FileSummary& file);

}  // namespace rodsweep
