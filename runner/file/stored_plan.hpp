// The plan of a results file, made again from the job that the file holds.
#pragma once

#include <filesystem>

#include "runner/file/inspect.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

/// The job file as the last start found it, where relative paths in the job begin; the results file where none says.
std::filesystem::path stored_job_path(const FileSummary& file);

/// The job that the file holds. Its relative paths begin where its own file was, or, if it cannot be read so, where
/// `other` is, another job file that names the same models and data sets. Throws FileError for a job that this version
/// does not accept.
Job stored_job(const FileSummary& file, const std::filesystem::path& other = {},
               MissingFiles missing = MissingFiles::refused);

/// Likewise of a file's job.
Plan planned(const FileSummary& file, Job job);
Plan stored_plan(const FileSummary& file);

}  // namespace rodsweep
