#include "runner/command/run_command.hpp"

#include <fmt/format.h>

#include "runner/command/next_command.hpp"
#include "runner/file/file_error.hpp"
#include "runner/measure/inputs.hpp"
#include "solver/cg/petsc_session.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

/// Rank 0 reads the job and its input files, then broadcasts the job's text and the files' hashes. So all ranks use the
/// same input even if their copies differ, and only one rank reads the data sets to hash them.
Job read_job_everywhere(const fs::path& path, const MpiSession& mpi) {
  std::optional<Job> job;
  by_rank_0(mpi.world(), [&] {
    job = read_job(path);
    check_inputs(*job);
  });
  const std::string text = broadcast(job ? job->text : std::string(), mpi.world());
  const InputFiles files = from_bytes(broadcast(job ? to_bytes(job->files) : std::string(), mpi.world()));
  return collectively(mpi.world(), [&] { return job ? std::move(*job) : parse_job(text, path, files); });
}

}  // namespace

ExitCode execute(const RunOptions& options, const MpiSession& mpi, Console& console) {
  std::optional<PetscSession> petsc;
  collectively(mpi.world(), [&] { petsc.emplace(); });
  const Job job = read_job_everywhere(options.job, mpi);
  if (const int ranks = ranks_of(options, job); options.workers && mpi.size() != ranks) {
    console.error(fmt::format("-n {} needs {} ranks, but {} were started: leave out -n under mpirun and srun",
                              *options.workers, ranks, mpi.size()));
    return ExitCode::user_error;
  }
  for (const std::string& warning : job.warnings) console.warn(warning);
  if (const auto idle = idle_petsc_options(); !idle.empty())
    console.warn(fmt::format("PETSC_OPTIONS: {} {} no effect: \"solve\" in the job chooses solver and preconditioner",
                             fmt::join(idle, ", "), idle.size() == 1 ? "has" : "have"));
  return is_training(job) ? run_training(options, job, mpi, console) : run_sweep(options, job, mpi, console);
}

int ranks_of(const RunOptions& options, const Job& job) {
  const int workers = options.workers.value_or(1);
  return is_training(job) ? workers : ranks_for(workers);
}

fs::path output_of(const RunOptions& options, const std::string& job_name) {
  const std::string part = options.shard ? fmt::format("-{}of{}", options.shard->number, options.shard->of) : "";
  const std::string name = job_name + part + ".h5";
  const fs::path path = options.output.value_or(fs::path("results") / name);
  if (std::error_code error; fs::is_directory(path, error))
    throw FileError(fmt::format("{} is a folder: name a file, such as -o {}", path.native(), (path / name).native()));
  return path;
}

Provenance provenance_of(const RunOptions& options, const MpiSession& mpi, const Placement& where) {
  Provenance provenance = provenance_of_this_process(options.command);
  provenance.job = fs::absolute(options.job).lexically_normal().native();
  provenance.ranks = mpi.size();
  if (options.shard) provenance.shard = options.shard->number, provenance.shards = options.shard->of;
  provenance.oversubscribed = where.oversubscribed;
  return provenance;
}

}  // namespace rodsweep
