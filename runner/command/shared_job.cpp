#include "runner/command/shared_job.hpp"

#include <optional>

#include "runner/experiment/inputs.hpp"

namespace rodsweep {

Job read_job_everywhere(const std::filesystem::path& path, const MpiSession& mpi) {
  std::optional<Job> job;
  collectively(mpi.world(), [&] {
    if (mpi.rank() > 0) return;
    job = read_job(path);
    check_inputs(*job);
  });
  const std::string text = broadcast(job ? job->text : std::string(), mpi.world());
  collectively(mpi.world(), [&] {
    if (!job) job = parse_job(text, path);
  });
  return std::move(*job);
}

}  // namespace rodsweep
