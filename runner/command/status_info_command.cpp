#include "runner/command/status_info_command.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "runner/command/training_summary.hpp"
#include "runner/file/inspect.hpp"
#include "runner/terminal/text.hpp"
#include "runner/training/model_file.hpp"

namespace rodsweep {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t failures_shown = 10;

std::string by_outcome(const FileSummary& file) {
  std::string text;
  for (const auto& [outcome, count] : file.done_by_outcome)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, outcome);
  return text.empty() ? "none yet" : text;
}

std::string ending(const RunRow& run) {
  if (run.end_utc.empty()) return "runs still, or was killed";
  switch (static_cast<ExitCode>(run.exit_code)) {
    case ExitCode::ok: return "all done";
    case ExitCode::tasks_failed: return "complete, some tasks failed";
    case ExitCode::stopped: return "stopped early";
    default: return fmt::format("exit code {}", run.exit_code);
  }
}

std::string run_line(std::size_t index, const RunRow& run) {
  const Provenance& p = run.provenance;
  return fmt::format("start {}{}: {} to {} on {}, {} rank{}{}: {} tasks in {} of work; {}\n", index,
                     run.source.empty() ? "" : fmt::format(" (of {}, extended here)", run.source), p.begin_utc,
                     run.end_utc.empty() ? "?" : run.end_utc, p.host, p.ranks, p.ranks == 1 ? "" : "s",
                     p.oversubscribed ? " (more than cores: times are worthless)" : "", run.tasks,
                     duration_text(run.task_seconds), ending(run));
}

Json to_json(const FileSummary& file) {
  Json json{{"file", file.path.native()},
            {"job", file.job_name},
            {"tasks", file.tasks},
            {"done", file.done},
            {"failed", file.failed},
            {"pending", file.pending},
            {"outcomes", file.done_by_outcome}};
  json["failures"] = Json::array();
  for (const FailedTask& task : file.failures)
    json["failures"].push_back({{"task", task.index}, {"outcome", task.outcome}, {"message", task.message}});
  json["starts"] = Json::array();
  for (const RunRow& run : file.runs) {
    const Provenance& p = run.provenance;
    json["starts"].push_back({{"begin", p.begin_utc},
                              {"end", run.end_utc.empty() ? Json() : Json(run.end_utc)},
                              {"exit_code", run.end_utc.empty() ? Json() : Json(run.exit_code)},
                              {"tasks", run.tasks},
                              {"task_seconds", run.task_seconds},
                              {"host", p.host},
                              {"ranks", p.ranks},
                              {"oversubscribed", p.oversubscribed},
                              {"command", p.user_command},
                              {"source", run.source},
                              {"revision", p.revision},
                              {"versions", p.versions},
                              {"petsc_options", p.petsc_options}});
  }
  return json;
}

std::string provenance_text(const FileSummary& file) {
  std::string text = fmt::format("file     {}, {}, schema {}\njob      {} ({})\nplan     {} tasks, hash {}\n",
                                 file.path.native(), bytes_text(static_cast<std::int64_t>(file.bytes)),
                                 file.schema_version, file.job_name, file.job_kind, file.tasks, file.plan_hash);
  if (file.rerun_of_task) text += fmt::format("holds    task {} of the job alone, run again\n", *file.rerun_of_task);
  if (!file.guesses.empty()) text += fmt::format("guesses  {}\n", fmt::join(file.guesses, ", "));
  text += fmt::format("done     {} of {} tasks: {}\n", file.done, file.tasks, by_outcome(file));
  if (file.momentum_residual)
    text += fmt::format("momentum in a step, forces on a segment lack at most {:.2g} of the greatest of a joint\n",
                        *file.momentum_residual);
  for (std::size_t i = 0; i < file.runs.size(); ++i) {
    const Provenance& p = file.runs[i].provenance;
    text += run_line(i, file.runs[i]);
    text += fmt::format("  command   {}\n  revision  {}\n  versions  {}\n", p.user_command, p.revision, p.versions);
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
    console.result(to_json(stored, options.file).dump(2));
  } else {
    console.result(training_summary(stored.card, options.file) + '\n' + provenance_text(stored));
    if (options.verify) console.result("verified: the model is as it was written");  // else it could not be read
  }
  return ExitCode::ok;
}

}  // namespace

ExitCode execute(const StatusOptions& options, Console& console) {
  if (is_model_file(options.file)) {
    const StoredModel stored = read_training(options.file);
    console.result(options.json ? to_json(stored, options.file).dump(2) : training_summary(stored.card, options.file));
    return ExitCode::ok;
  }
  const FileSummary file = inspect(options.file);
  if (options.json) {
    console.result(to_json(file).dump(2));
    return ExitCode::ok;
  }
  std::string text = fmt::format("{}: {} of {} tasks done ({} %): {}\n", file.job_name, file.done, file.tasks,
                                 file.tasks > 0 ? 100 * file.done / file.tasks : 100, by_outcome(file));
  for (std::size_t i = 0; i < file.failures.size() && i < failures_shown; ++i)
    text +=
        fmt::format("  task {} {}: {}\n", file.failures[i].index, file.failures[i].outcome, file.failures[i].message);
  if (file.failures.size() > failures_shown)
    text += fmt::format("  and {} more: --json lists them all\n", file.failures.size() - failures_shown);
  if (!file.runs.empty()) text += run_line(file.runs.size() - 1, file.runs.back());
  text.pop_back();
  console.result(text);
  return ExitCode::ok;
}

ExitCode execute(const InfoOptions& options, Console& console) {
  if (is_model_file(options.file)) return show_model(options, console);
  const FileSummary file = inspect(options.file);
  if (options.job) {
    console.raw_result(file.job_text);
    return ExitCode::ok;
  }
  const Verification verified = options.verify ? verify(options.file) : Verification{};
  if (options.json) {
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
    console.result(json.dump(2));
  } else {
    console.result(provenance_text(file));
    if (options.verify)
      console.result(fmt::format(
          "verified {} finished tasks: {}", verified.checked,
          verified.damaged.empty() ? "all as they were written" : fmt::format("{} differ", verified.damaged.size())));
  }
  if (verified.damaged.empty()) return ExitCode::ok;
  console.error(fmt::format("{} is damaged: the data of task{} {} are not what was written", options.file.native(),
                            verified.damaged.size() == 1 ? "" : "s", fmt::join(verified.damaged, ", ")));
  return ExitCode::user_error;
}

}  // namespace rodsweep
