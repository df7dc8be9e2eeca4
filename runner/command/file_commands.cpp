// The commands `status` and `info`: reports on a results file, as text and as JSON.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <optional>
#include <thread>

#include "runner/command/commands.hpp"
#include "runner/command/run_command.hpp"
#include "runner/command/training_summary.hpp"
#include "runner/file/file_reading.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/stored_plan.hpp"
#include "runner/file/unfinished_file.hpp"
#include "runner/terminal/formats.hpp"
#include "runner/training/model_file.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

/// Whether a run is writing the file. Uses the run's lock, which the system releases when the run dies. Without locks,
/// uses the file's modification time, which a run renews.
bool is_alive(const FileSummary& file) {
  if (file.runs.empty() || !file.runs.back().end_utc.empty()) return false;
  return file.being_written.value_or(file.silent_s < alive_s);
}

/// "98 ok, 2 torn"
std::string outcomes_text(const FileSummary& file) {
  std::string text;
  for (const auto& [outcome, count] : file.done_by_outcome)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, outcome);
  return text.empty() ? "none yet" : text;
}

constexpr double hung_s = 60;  // a run without activity for this long may hang

std::string life_text(const FileSummary& file) {
  const std::string silence = duration_text(std::round(file.silent_s));
  if (!is_alive(file))
    return file.being_written ? "was killed" : fmt::format("was killed or hangs: no activity for {}", silence);
  if (file.silent_s > hung_s)
    return fmt::format("running, but no activity for {}: the program or a disk may hang", silence);
  return fmt::format("running, last activity {} ago", silence);
}

std::string ending(const RunRow& run, bool is_last, const FileSummary& file) {
  if (run.end_utc.empty()) return is_last ? life_text(file) : "was killed";
  switch (static_cast<ExitCode>(run.exit_code)) {
    case ExitCode::ok: return "all done";
    case ExitCode::tasks_failed: return "complete, but some tasks failed";
    case ExitCode::stopped: return "stopped early";
    case ExitCode::too_long: return "stopped early: its tasks need a longer time limit or more memory";
    case ExitCode::lost: return "all workers were lost";
    default: return fmt::format("exit code {}", run.exit_code);
  }
}

/// One line about run `index` of the sweep.
std::string run_text(const FileSummary& file, std::size_t index) {
  const RunRow& run = file.runs.at(index);
  const Provenance& p = run.provenance;
  return fmt::format("run {}{}: {} to {} on {}, {}{}: {} in {} of work; {}\n", index,
                     run.source.empty() ? "" : fmt::format(" (copied from {})", run.source), p.begin_utc,
                     run.end_utc.empty() ? "?" : run.end_utc, p.host, count_text(p.ranks, "rank"),
                     p.oversubscribed ? " (more than cores: times are not valid)" : "", count_text(run.tasks, "task"),
                     duration_text(run.task_seconds), ending(run, index + 1 == file.runs.size(), file));
}

/// The tasks of the last run: all tasks, or those of its shard.
struct Share {
  std::optional<Shard> shard;
  std::int64_t tasks = 0, left = 0;
};

Share share_of(const FileSummary& file) {
  Share share{std::nullopt, file.tasks, file.pending};
  if (file.runs.empty()) return share;
  if (const Provenance& last = file.runs.back().provenance; last.shard > 0) {
    share.shard = Shard{last.shard, last.shards};
    share.tasks = share_of(*share.shard, file.tasks);
    share.left = std::max<std::int64_t>(share.tasks - file.done, 0);
  }
  return share;
}

/// Tasks per second of the current run; none before its first task.
std::optional<double> rate_of(const FileSummary& file) {
  if (!is_alive(file)) return std::nullopt;
  const RunRow& run = file.runs.back();
  const double since = std::difftime(std::time(nullptr), seconds_of_utc(run.provenance.begin_utc));
  if (run.tasks == 0 || !(since > 0)) return std::nullopt;
  return static_cast<double>(run.tasks) / since;
}

/// Time left of the current run, by its own estimate; none before its first task and when it is overdue.
std::optional<double> seconds_left(const FileSummary& file) {
  if (!is_alive(file)) return std::nullopt;
  const double left = file.runs.back().left_s - file.silent_s;
  return left > 0 ? std::optional(left) : std::nullopt;
}

nlohmann::ordered_json to_json(const FileSummary& file) {
  using Json = nlohmann::ordered_json;
  Json json{{"file", file.path.native()},
            {"job", file.job_name},
            {"tasks", file.tasks},
            {"done", file.done},
            {"failed", file.failed},
            {"pending", file.pending},
            {"outcomes", file.done_by_outcome},
            {"being_written", file.being_written ? Json(*file.being_written) : Json()},
            {"alive", is_alive(file)},
            {"silent_s", is_alive(file) ? Json(file.silent_s) : Json()}};
  const std::optional<double> rate = rate_of(file);
  const Share share = share_of(file);
  json["tasks_per_s"] = rate ? Json(*rate) : Json();
  const std::optional<double> left = seconds_left(file);
  json["left_s"] = left ? Json(*left) : Json();
  json["shard"] =
      share.shard ? Json{{"number", share.shard->number}, {"of", share.shard->of}, {"tasks", share.tasks}} : Json();
  json["failures"] = Json::array();
  for (const FailedTask& task : file.failures)
    json["failures"].push_back({{"task", task.index}, {"outcome", task.outcome}, {"message", task.message}});
  json["running"] = Json::array();
  for (const BegunTask& task : file.begun)
    if (is_alive(file) && task.run + 1 == static_cast<int>(file.runs.size()))
      json["running"].push_back({{"task", task.index}, {"host", task.host}, {"rank", task.rank}});
  json["runs"] = Json::array();
  for (const RunRow& run : file.runs) {
    const Provenance& p = run.provenance;
    json["runs"].push_back(to_json(run));
    json["runs"].back().update({{"tasks", run.tasks},
                                {"task_seconds", run.task_seconds},
                                {"oversubscribed", p.oversubscribed},
                                {"source", run.source},
                                {"petsc_options", p.petsc_options}});
  }
  return json;
}

std::string provenance_text(const FileSummary& file) {
  std::string text =
      fmt::format("file     {}, {}, schema {}\njob      {} ({})\nplan     {}, hash {}\n", file.path.native(),
                  bytes_text(static_cast<std::int64_t>(file.bytes)), file.schema_version, file.job_name, file.job_kind,
                  count_text(file.tasks, "task"), file.plan_hash);
  if (file.rerun_of_task)
    text += fmt::format("holds    only task {} of the job, from `rodsweep rerun`\n", *file.rerun_of_task);
  if (!file.guesses.empty()) text += fmt::format("guesses  {}\n", fmt::join(file.guesses, ", "));
  text += fmt::format("done     {} of {}: {}\n", file.done, count_text(file.tasks, "task"), outcomes_text(file));
  if (file.momentum_residual)
    text += fmt::format("momentum residual of a segment: at most {:.2g} of the greatest joint force in a step\n",
                        *file.momentum_residual);
  for (std::size_t i = 0; i < file.runs.size(); ++i) {
    const Provenance& p = file.runs[i].provenance;
    text += run_text(file, i) + program_text(p);
    if (!p.petsc_options.empty()) text += fmt::format("  PETSC_OPTIONS  {}\n", p.petsc_options);
  }
  text.pop_back();
  return text;
}

ExitCode show_model(const InfoOptions& options, Console& console) {
  const StoredModel stored = read_training(options.file);
  if (options.job) {
    console.raw_result(stored.card.job_text);
  } else if (options.json) {
    console.result(json_text(to_json(stored, options.file)));
  } else {
    console.result(training_summary(stored.card, options.file) + '\n' + provenance_text(stored));
    if (options.verify) console.result("verified: the model is intact");  // reading it checks this
  }
  return ExitCode::ok;
}

/// Checks what task checksums don't cover (parameters, axes, row positions) against a plan rebuilt from the job.
/// Returns false if it can't: a rerun, a file of another revision, or a job with input files.
bool verify_plan(const FileSummary& file) {
  if (file.rerun_of_task || file.runs.empty() || file.runs.front().provenance.revision != source_revision())
    return false;
  try {
    const Job job = parse_job(file.job_text, stored_job_path(file), MissingFiles::accepted);
    if (!job.files.empty()) return false;  // they may have changed
    check_same_plan(file.path, Plan(job), "This is that revision, so the file is damaged: create it again");
    return true;
  } catch (const JobError& error) {
    throw damaged_error(file.path, error.what());
  }
}

constexpr std::size_t failures_shown = 10, running_shown = 10;

std::string progress_text(const FileSummary& file) {
  const Share share = share_of(file);
  const std::int64_t done = share.tasks - share.left;
  std::string text = file.job_name;
  if (share.shard) text += fmt::format(", shard {} of {}", share.shard->number, share.shard->of);
  text += fmt::format(": {} of {} done ({} %): {}", done, count_text(share.tasks, "task"),
                      share.tasks > 0 ? 100 * done / share.tasks : 100, outcomes_text(file));
  if (const auto rate = rate_of(file)) text += fmt::format("; {:.3g} tasks/s", *rate);
  if (const auto left = seconds_left(file)) text += fmt::format(", {} left", duration_text(*left));
  return text;
}

/// The tasks that workers of the last run are running.
std::string running_text(const FileSummary& file) {
  const int last = static_cast<int>(file.runs.size()) - 1;
  std::string text;
  std::size_t shown = 0, more = 0;
  for (const BegunTask& task : file.begun) {
    if (task.run != last) continue;
    if (shown == running_shown) {
      ++more;
      continue;
    }
    ++shown;
    text += fmt::format("  task {} runs on {}, rank {}\n", task.index, task.host, task.rank);
  }
  if (more > 0) text += fmt::format("  and {} more: --json lists them all\n", more);
  return text;
}

std::string status_text(const FileSummary& file) {
  std::string text = progress_text(file) + '\n';
  for (std::size_t i = 0; i < file.failures.size() && i < failures_shown; ++i)
    text +=
        fmt::format("  task {} {}: {}\n", file.failures[i].index, file.failures[i].outcome, file.failures[i].message);
  if (file.failures.size() > failures_shown)
    text += fmt::format("  and {} more: --json lists them all\n", file.failures.size() - failures_shown);
  if (is_alive(file)) text += running_text(file);
  if (!file.runs.empty()) text += run_text(file, file.runs.size() - 1);
  text.pop_back();
  return text;
}

}  // namespace

ExitCode execute(const InfoOptions& options, Console& console) {
  if (is_model_file(options.file)) return show_model(options, console);
  const FileSummary file = inspect(options.file);
  if (options.job) {
    console.raw_result(file.job_text);
    return ExitCode::ok;
  }
  const Verification verified = options.verify ? verify(options.file) : Verification{};
  const bool plan_verified = options.verify && verify_plan(file);
  if (options.json) {
    using Json = nlohmann::ordered_json;
    Json json = to_json(file);
    json["bytes"] = file.bytes;
    json["kind"] = file.job_kind;
    json["schema_version"] = file.schema_version;
    json["plan_hash"] = file.plan_hash;
    if (file.rerun_of_task) json["rerun_of_task"] = *file.rerun_of_task;
    json["guesses"] = file.guesses;
    json["momentum_residual"] = file.momentum_residual ? Json(*file.momentum_residual) : Json();
    json["tolerances"] = file.tolerances;
    if (options.verify) json["verified"] = {{"checked", verified.checked}, {"damaged", verified.damaged}};
    console.result(json_text(json));
  } else {
    console.result(provenance_text(file));
    if (options.verify)
      console.result(
          fmt::format("verified {} finished tasks: {}{}", verified.checked,
                      verified.damaged.empty() ? "all intact" : fmt::format("{} damaged", verified.damaged.size()),
                      plan_verified ? "; the parameters match the job" : ""));
  }
  if (verified.damaged.empty()) return ExitCode::ok;
  console.error(
      fmt::format("{} is damaged: wrong checksum of task{} {}. Run its job with --resume to repeat damaged tasks; if "
                  "it is a compressed copy, copy the original again",
                  options.file.native(), verified.damaged.size() == 1 ? "" : "s", fmt::join(verified.damaged, ", ")));
  return ExitCode::damaged;
}

ExitCode execute(const StatusOptions& options, Console& console) {
  if (const std::string left = unfinished_text(options.file); fs::exists(options.file) && !left.empty())
    console.warn(left);
  if (is_model_file(options.file)) {
    const StoredModel stored = read_training(options.file);
    console.result(options.json ? json_text(to_json(stored, options.file))
                                : training_summary(stored.card, options.file));
    return ExitCode::ok;
  }
  for (;;) {
    const FileSummary file = inspect(options.file);
    const bool last = options.watch_s == 0 || !is_alive(file);
    if (options.json)
      console.result(json_text(to_json(file), options.watch_s == 0 ? 2 : -1));  // --watch: one object per line
    else
      console.result(last ? status_text(file) : progress_text(file));
    if (last) return ExitCode::ok;
    std::this_thread::sleep_for(std::chrono::duration<double>(options.watch_s));
  }
}

}  // namespace rodsweep
