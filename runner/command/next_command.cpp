#include "runner/command/next_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "runner/dispatch/stop_signal.hpp"
#include "runner/terminal/formats.hpp"
#include "runner/text/beside_program.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

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
