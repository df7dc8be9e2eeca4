// The plan of a results file, rebuilt from the job stored in it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

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

/// Checks whether a sweep can be resumed in a file. One process, read-only. Throws FileError with the difference and
/// advice.
struct ResumePoint {
  std::vector<std::uint8_t> done;   ///< raw state bytes, by task index
  std::vector<std::uint8_t> tries;  ///< /timing/tasks/tries, by task index
  int runs = 0;                     ///< number of used rows of /runs
};

/// Throws unless the plan has the same tasks as the file.
void check_same_tasks(const std::filesystem::path& path, const Plan& plan);

/// Throws, with `advice`, unless the file was made from this plan by a program that expands its job in the same way.
void check_same_plan(const std::filesystem::path& path, const Plan& plan, const char* advice);

ResumePoint check_resumable(const std::filesystem::path& path, const Plan& plan);

}  // namespace rodsweep
