#include "runner/file/stored_plan.hpp"

#include <fmt/format.h>

namespace rodsweep {

std::filesystem::path stored_job_path(const FileSummary& file) {
  for (auto run = file.runs.rbegin(); run != file.runs.rend(); ++run)
    if (!run->provenance.job.empty()) return run->provenance.job;
  return file.path;
}

Plan stored_plan(const FileSummary& file) {
  try {
    return Plan(parse_job(file.job_text, stored_job_path(file)));
  } catch (const JobError& error) {
    const std::string revision = file.runs.empty() ? "unknown" : file.runs.front().provenance.revision;
    throw FileError(
        fmt::format("{} holds a job that this rodsweep does not accept; use the one that wrote it (revision {}), or "
                    "put the job's files back where they were:\n{}",
                    file.path.native(), revision, error.what()));
  }
}

}  // namespace rodsweep
