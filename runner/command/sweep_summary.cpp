#include "runner/command/sweep_opening.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "runner/terminal/formats.hpp"

namespace rodsweep {

namespace {

const std::string ok_name = to_string(TaskOutcome::ok);

/// All finished tasks by outcome, including earlier runs.
std::map<std::string, std::int64_t> finished(const SweepSummary& summary) {
  auto counts = summary.before;
  for (std::size_t i = 0; i < summary.dispatch.finished.size(); ++i)
    if (const auto count = summary.dispatch.finished[i]; count > 0)
      counts[to_string(static_cast<TaskOutcome>(i))] += count;
  return counts;
}

std::int64_t finished_now(const Dispatch& dispatch) {
  std::int64_t count = 0;
  for (const std::int64_t of_outcome : dispatch.finished) count += of_outcome;
  return count;
}

}  // namespace

ExitCode exit_code(const SweepSummary& summary) {
  if (summary.dispatch.late && finished_now(summary.dispatch) == 0) return ExitCode::too_long;
  if (const auto left = summary.dispatch.left; left > 0 && left == summary.too_large.tasks) return ExitCode::too_long;
  if (summary.dispatch.left > 0)
    return summary.dispatch.signal != 0 || summary.dispatch.late ? ExitCode::stopped : ExitCode::lost;
  const auto counts = finished(summary);
  const bool failures = std::any_of(counts.begin(), counts.end(), [](const auto& c) { return c.first != ok_name; });
  return failures ? ExitCode::tasks_failed : ExitCode::ok;
}

std::string summary_text(const SweepSummary& summary) {
  const Dispatch& dispatch = summary.dispatch;
  auto counts = finished(summary);
  std::string text = count_text(summary.tasks, "task");
  if (const auto& shard = summary.shard)
    text = fmt::format("shard {} of {}, {} of {}", shard->number, shard->of, share_of(*shard, summary.tasks), text);
  text += fmt::format(": {} ok", counts[ok_name]);
  counts.erase(ok_name);
  for (const auto& [outcome, count] : counts) text += fmt::format(", {} {}", count, outcome);
  if (dispatch.left > 0) text += fmt::format(", {} left to do", dispatch.left);
  text += '\n';

  auto failures = dispatch.failures;
  std::sort(failures.begin(), failures.end(), [](const auto& a, const auto& b) { return a.task < b.task; });
  for (const auto& failure : failures)
    text += fmt::format("  task {} {}: {}\n", failure.task, to_string(failure.outcome), failure.message);
  const auto failed_now = finished_now(dispatch) - dispatch.finished[static_cast<std::size_t>(TaskOutcome::ok)];
  if (failed_now > static_cast<std::int64_t>(failures.size()))
    text += fmt::format("  and {} more\n", failed_now - static_cast<std::int64_t>(failures.size()));

  if (const auto& [timed, missed] = summary.solves; missed > 0)
    text += fmt::format("{} of {} missed the tolerance: their guesses have no times in these tasks\n", missed,
                        count_text(timed, "solve"));
  if (const auto now = finished_now(dispatch); now > 0 && dispatch.wall_s > 0)
    text +=
        fmt::format("{} for {}, {:.3g} tasks/s, {} busy {:.0f} % of the time\n", duration_text(dispatch.wall_s),
                    count_text(now, "task"), static_cast<double>(now) / dispatch.wall_s,
                    count_text(summary.workers, "worker"), 100 * dispatch.busy_s / (summary.workers * dispatch.wall_s));
  std::int64_t again = 0;
  for (const TaskOutcome outcome : {TaskOutcome::error, TaskOutcome::timed_out, TaskOutcome::crashed})
    again += counts[to_string(outcome)];
  if (again > 0 && dispatch.left == 0)
    text += fmt::format("--resume --retry-failed repeats the {} that ended in an error, timed out or crashed\n",
                        again == 1 ? "task" : count_text(again, "task"));
  text += "results: " + summary.path.native();
  if (dispatch.left > 0) return text;
  if (summary.shard)
    text += "\nnext, when all shards are done: " + merge_line(summary.program, summary.path, *summary.shard);
  else
    text += "\nnext: " + script_line("summary.py", summary.path);
  return text;
}

std::string ended_text(const SweepSummary& summary, const RunOptions& options, int ranks) {
  const Dispatch& dispatch = summary.dispatch;
  RunOptions again = options;
  again.resume = true;
  if (dispatch.signal != 0) return stopped_text(dispatch.signal, again, ranks);
  if (dispatch.left == summary.too_large.tasks)
    return fmt::format("the remaining tasks do not fit into memory (see above). To continue with more memory: {}",
                       run_line(again, ranks));
  if (exit_code(summary) == ExitCode::too_long) {
    again.time_limit_s.reset();
    return fmt::format(
        "no task ended within the time limit of {}. To continue, raise --time-limit (under Slurm sbatch --time), or "
        "stop long tasks with --task-time-limit: {}",
        duration_text(*options.time_limit_s), run_line(again, ranks));
  }
  return fmt::format("{}; finished tasks are kept. To continue: {}",
                     dispatch.late ? "no time is left for the remaining tasks" : "all workers were lost",
                     run_line(again, ranks));
}

}  // namespace rodsweep
