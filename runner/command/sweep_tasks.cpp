#include "runner/command/sweep_tasks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace rodsweep {

std::vector<PendingTask> all_tasks(const Plan& plan, const std::vector<std::uint8_t>& tries,
                                   const std::optional<Extension>& extension) {
  std::vector<PendingTask> tasks;
  for (const Task& task : plan.tasks())
    tasks.push_back({task.index, task.cost * (extension ? extension->cost(task.index) : 1),
                     tries[static_cast<std::size_t>(task.index)]});
  return tasks;
}

std::vector<PendingTask> leave_out(std::vector<PendingTask>& tasks, const TaskFilter& stays) {
  const auto end = std::stable_partition(tasks.begin(), tasks.end(), stays);
  std::vector<PendingTask> left_out(end, tasks.end());
  tasks.erase(end, tasks.end());
  return left_out;
}

TaskFilter not_done(const std::vector<std::uint8_t>& done) {
  return [&done](const PendingTask& task) { return done[static_cast<std::size_t>(task.index)] == 0; };
}

TaskFilter not_crashed(int max_crashes) {
  return [max_crashes](const PendingTask& task) { return task.crashes < max_crashes; };
}

TaskFilter in_shard(const Plan& plan, const std::optional<Shard>& shard) {
  if (!shard) return [](const PendingTask&) { return true; };
  std::vector<std::int64_t> order(static_cast<std::size_t>(plan.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int64_t a, std::int64_t b) { return plan.cost(a) > plan.cost(b); });
  std::vector<bool> mine(order.size(), false);
  for (auto i = static_cast<std::size_t>(shard->number) - 1; i < order.size(); i += static_cast<std::size_t>(shard->of))
    mine[static_cast<std::size_t>(order[i])] = true;
  return [mine = std::move(mine)](const PendingTask& task) { return mine[static_cast<std::size_t>(task.index)]; };
}

TaskFilter fits_memory(const Plan& plan, double memory) {
  return [&plan, memory, of_a_row = row_bytes(axis_sizes(plan))](const PendingTask& task) {
    return static_cast<double>(record_bytes(plan.task(task.index), of_a_row)) <= memory;
  };
}

TooLarge largest_of(const std::vector<PendingTask>& tasks, const Plan& plan) {
  const PerRows<std::int64_t> of_a_row = row_bytes(axis_sizes(plan));
  TooLarge found;
  for (const PendingTask& task : tasks) {
    ++found.tasks;
    const std::int64_t bytes = record_bytes(plan.task(task.index), of_a_row);
    if (bytes > found.bytes) found.task = task.index, found.bytes = bytes;
  }
  return found;
}

std::string store_as_crashed(const Task& task, int crashes, const Plan& plan, ResultsFile& file) {
  TaskRecord record;
  record.prepare(task, axis_sizes(plan));
  record.outcome = TaskOutcome::crashed;
  record.message =
      crashes == 1
          ? "the worker or the sweep crashed or hung in the only try"
          : fmt::format(
                "the worker or the sweep crashed or hung in each of its {} tries; in the last try the task ran alone",
                crashes);
  file.write(task, record);
  return record.message;
}

}  // namespace rodsweep
