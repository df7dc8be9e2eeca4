// The plan of a results file, rebuilt from the job stored in it.
#pragma once

#include <filesystem>

#include "runner/file/inspect.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

/// The path of the job file of the last run that stored one, the base of relative paths; else the results file.
std::filesystem::path stored_job_path(const FileSummary& file);

/// The job stored in the file. Relative paths start at its original folder. If it can't be read that way, they start at
/// `other`, another job file with the same models and data sets. Throws FileError if this version does not accept the
/// job.
Job stored_job(const FileSummary& file, const std::filesystem::path& other = {},
               MissingFiles missing = MissingFiles::refused);

/// The plan of a file's job. Throws FileError likewise.
Plan planned(const FileSummary& file, Job job);
Plan stored_plan(const FileSummary& file);

}  // namespace rodsweep
