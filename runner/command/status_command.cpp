#include "runner/command/status_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>

#include "runner/command/file_report.hpp"
#include "runner/command/training_summary.hpp"
#include "runner/file/unfinished_file.hpp"
#include "runner/terminal/formats.hpp"
#include "runner/training/model_file.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t failures_shown = 10, running_shown = 10;

std::string progress_text(const FileSummary& file) {
  const Share share = share_of(file);
  const std::int64_t done = share.tasks - share.left;
  std::string text = file.job_name;
  if (share.shard) text += fmt::format(", shard {} of {}", share.shard->number, share.shard->of);
  text += fmt::format(": {} of {} done ({} %): {}", done, counted(share.tasks, "task"),
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
