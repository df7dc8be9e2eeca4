#include "runner/file/stored_plan.hpp"

#include <fmt/format.h>

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

FileError not_accepted(const FileSummary& file, const JobError& error) {
  const std::string revision = file.runs.empty() ? "unknown" : file.runs.front().provenance.revision;
  return FileError(
      fmt::format("{} holds a job that this rodsweep does not accept; use the revision that wrote it ({}), or restore "
                  "the input files of the job:\n"
                  "{}",
                  file.path.native(), revision, error.what()));
}

}  // namespace

fs::path stored_job_path(const FileSummary& file) {
  for (auto run = file.runs.rbegin(); run != file.runs.rend(); ++run)
    if (!run->provenance.job.empty()) return run->provenance.job;
  return file.path;
}

Job stored_job(const FileSummary& file, const fs::path& other, MissingFiles missing) {
  try {
    return parse_job(file.job_text, stored_job_path(file), missing);
  } catch (const JobError& error) {
    if (!other.empty()) {
      try {
        return parse_job(file.job_text, other);
      } catch (const JobError&) {  // report the first error
      }
    }
    throw not_accepted(file, error);
  }
}

Plan planned(const FileSummary& file, Job job) {
  try {
    return Plan(std::move(job));
  } catch (const JobError& error) {
    throw not_accepted(file, error);
  }
}

Plan stored_plan(const FileSummary& file) { return planned(file, stored_job(file)); }

}  // namespace rodsweep
