#include "runner/command/file_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <optional>

#include "runner/command/exit_codes.hpp"
#include "runner/terminal/formats.hpp"

namespace rodsweep {

std::string outcomes_text(const FileSummary& file) {
  std::string text;
  for (const auto& [outcome, count] : file.done_by_outcome)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, outcome);
  return text.empty() ? "none yet" : text;
}

namespace {

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

}  // namespace

std::string run_text(const FileSummary& file, std::size_t index) {
  const RunRow& run = file.runs.at(index);
  const Provenance& p = run.provenance;
  return fmt::format("run {}{}: {} to {} on {}, {}{}: {} in {} of work; {}\n", index,
                     run.source.empty() ? "" : fmt::format(" (copied from {})", run.source), p.begin_utc,
                     run.end_utc.empty() ? "?" : run.end_utc, p.host, counted(p.ranks, "rank"),
                     p.oversubscribed ? " (more than cores: times are not valid)" : "", counted(run.tasks, "task"),
                     duration_text(run.task_seconds), ending(run, index + 1 == file.runs.size(), file));
}

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

bool is_alive(const FileSummary& file) {
  if (file.runs.empty() || !file.runs.back().end_utc.empty()) return false;
  return file.being_written.value_or(file.silent_s < alive_s);
}

std::optional<double> rate_of(const FileSummary& file) {
  if (!is_alive(file)) return std::nullopt;
  const RunRow& run = file.runs.back();
  const double since = std::difftime(std::time(nullptr), seconds_of_utc(run.provenance.begin_utc));
  if (run.tasks == 0 || !(since > 0)) return std::nullopt;
  return static_cast<double>(run.tasks) / since;
}

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
    json["runs"].push_back({{"begin", p.begin_utc},
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

}  // namespace rodsweep
