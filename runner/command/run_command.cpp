#include "runner/command/run_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <charconv>
#include <system_error>

#include "runner/dispatch/stop_signal.hpp"
#include "runner/file/file_error.hpp"
#include "runner/measure/plan_check.hpp"
#include "runner/terminal/formats.hpp"
#include "runner/text/beside_program.hpp"
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

std::string path_from_here(const std::string& name) {
  const fs::path script =
      beside_program({fs::path("../share/rodsweep/analysis") / name, fs::path("../analysis") / name});
  if (script.empty()) return "analysis/" + name;
  std::error_code error;
  const std::string here = fs::proximate(script, error).native();
  return here.empty() || here.size() > script.native().size() ? script.native() : here;
}

/// Quoted for a shell; a name that begins with a dash is no option.
std::string word_of(const fs::path& path) {
  const std::string name = path.native();
  return shell_quoted(!name.empty() && name.front() == '-' ? "./" + name : name);
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
    throw FileError("{} is a folder: name a file, such as -o {}", path.native(), (path / name).native());
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

std::optional<Shard> shard_of(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, shard.number);
  if (number.ec != std::errc() || number.ptr == end || *number.ptr != '/') return std::nullopt;
  const auto of = std::from_chars(number.ptr + 1, end, shard.of);
  if (of.ec != std::errc() || of.ptr != end || shard.number < 1 || shard.number > shard.of) return std::nullopt;
  return shard;
}

std::int64_t share_of(const Shard& shard, std::int64_t tasks) { return (tasks - shard.number + shard.of) / shard.of; }

int ranks_for(int workers) { return workers > 1 ? workers + 1 : 1; }

std::string run_line(const RunOptions& options, int ranks) {
  std::string line;
  if (ranks > 1 && !options.workers)
    line = fmt::format("mpirun --oversubscribe {}-n {} ", geteuid() == 0 ? "--allow-run-as-root " : "", ranks);
  line += fmt::format("{} run {}", shell_quoted(options.program), word_of(options.job));
  if (options.workers) line += fmt::format(" -n {}", *options.workers);
  if (options.output) line += " -o " + word_of(*options.output);
  if (options.extend) line += " --extend " + word_of(*options.extend);
  if (options.shard) line += fmt::format(" --shard {}/{}", options.shard->number, options.shard->of);
  if (options.resume) line += " --resume";
  if (options.retry_failed) line += " --retry-failed";
  if (options.task_time_limit_s) line += fmt::format(" --task-time-limit {:g}", *options.task_time_limit_s);
  if (options.time_limit_s) line += fmt::format(" --time-limit {:g}", *options.time_limit_s);
  if (options.memory_limit_gb) line += fmt::format(" --memory-limit-gb {:g}", *options.memory_limit_gb);
  if (options.max_crashes != RunOptions().max_crashes) line += fmt::format(" --max-crashes {}", options.max_crashes);
  if (options.worker_timeout_s != RunOptions().worker_timeout_s)
    line += fmt::format(" --worker-timeout {:g}", options.worker_timeout_s);
  return line;
}

std::string stopped_text(int signal, RunOptions options, int ranks) {
  options.resume = true;
  return fmt::format("stopped early by {}; finished work is kept. To continue: {}", signal_cause(signal),
                     run_line(options, ranks));
}

std::string merge_line(const std::string& program, const fs::path& file, const Shard& shard) {
  const std::string name = file.filename().native();
  const std::string own = fmt::format("-{}of{}.h5", shard.number, shard.of);
  std::string files = "SHARDS... -o FILE";
  if (name.size() > own.size() && name.compare(name.size() - own.size(), own.size(), own) == 0) {
    const fs::path merged = file.parent_path() / name.substr(0, name.size() - own.size());
    files = fmt::format("{}-*of{}.h5 -o {}", word_of(merged), shard.of, word_of(merged.native() + ".h5"));
  }
  return fmt::format("{} merge {}", shell_quoted(program), files);
}

std::string compare_line(const std::string& program, const fs::path& file, const fs::path& other) {
  return fmt::format("{} compare {} {}", shell_quoted(program), word_of(file), word_of(other));
}

std::string script_line(const std::string& script, const fs::path& file) {
  return fmt::format("/usr/bin/python3 {} {}", shell_quoted(path_from_here(script)), word_of(file));
}

}  // namespace rodsweep
