#include "runner/command/sweep_tasks.hpp"

#include <algorithm>

namespace rodsweep {

bool has_crashed(const ResultsFile& file, std::int64_t task, int max_crashes) {
  const auto i = static_cast<std::size_t>(task);
  return file.done()[i] == 0 && file.tries()[i] >= max_crashes;
}

std::vector<PendingTask> pending_tasks(const Plan& plan, const ResultsFile& file,
                                       const std::optional<Extension>& extension, const std::optional<Shard>& shard,
                                       int max_crashes) {
  const std::vector<bool> mine = in_shard(plan, shard);
  std::vector<PendingTask> pending;
  for (const Task& task : plan.tasks())
    if (const auto i = static_cast<std::size_t>(task.index);
        mine[i] && !file.done()[i] && !has_crashed(file, task.index, max_crashes))
      pending.push_back({task.index, task.cost * (extension ? extension->cost(task.index) : 1), file.tries()[i]});
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

}  // namespace rodsweep
