#include "runner/command/sweep_tasks.hpp"

#include <algorithm>

#include "runner/file/inspect.hpp"

namespace rodsweep {

bool has_crashed(const ResultsFile& file, std::int64_t task, int max_crashes) {
  const auto i = static_cast<std::size_t>(task);
  return file.done()[i] == 0 && file.tries()[i] >= max_crashes;
}

std::vector<PendingTask> pending_tasks(const Plan& plan, const ResultsFile& file,
                                       const std::optional<Extension>& extension, const std::optional<Shard>& shard,
                                       int max_crashes) {
  const std::vector<bool> mine = in_shard(plan, shard);
  const double limit_s = plan.spec(0).time_limit_s;
  std::vector<PendingTask> pending;
  for (const Task& task : plan.tasks())
    if (const auto i = static_cast<std::size_t>(task.index);
        mine[i] && !file.done()[i] && !has_crashed(file, task.index, max_crashes)) {
      pending.push_back({task.index, task.cost * (extension ? extension->cost(task.index) : 1), file.tries()[i]});
      if (limit_s > 0) pending.back().limit_s = limit_s;
    }
  return pending;
}

TooLarge leave_out_too_large(const Plan& plan, std::vector<PendingTask>& pending, double memory) {
  const PerRows<std::int64_t> of_a_row = row_bytes(axis_sizes(plan));
  TooLarge found;
  const auto is_too_large = [&](const PendingTask& task) {
    const std::int64_t bytes = record_bytes(plan.task(task.index), of_a_row);
    if (static_cast<double>(bytes) <= memory) return false;
    ++found.tasks;
    if (bytes > found.bytes) found.task = task.index, found.bytes = bytes;
    return true;
  };
  pending.erase(std::remove_if(pending.begin(), pending.end(), is_too_large), pending.end());
  return found;
}

void learn_from_earlier_runs(const std::filesystem::path& path, const Plan& plan, const ResultsFile& file,
                             std::vector<PendingTask>& pending, TimeBudget& time) {
  const TaskTimes times = read_task_times(path);
  for (const Task& task : plan.tasks())
    if (const auto i = static_cast<std::size_t>(task.index); file.done()[i] != 0)
      time.learn(task.cost, TimeBudget::Seconds(times.elapsed_s.at(i)));
  for (PendingTask& task : pending) {
    const Try& tried = times.tried.at(static_cast<std::size_t>(task.index));
    const auto steps = static_cast<double>(plan.task(task.index).steps);
    task.tried_s = tried.elapsed_s;
    time.learn_part(task.cost, tried.steps / steps, TimeBudget::Seconds(tried.elapsed_s));
  }
}

}  // namespace rodsweep
