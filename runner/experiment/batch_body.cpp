#include "runner/experiment/batch_body.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "runner/experiment/batched_evaluation.hpp"
#include "solver/batch/batched_rods.hpp"

namespace rodsweep {

static_assert(Assign::most <= BatchedRods::lanes, "an assignment must fit into a batch");

std::vector<std::int64_t> batches(const Plan& plan) {
  if (plan.rows(Rows::system) == 0) return std::vector<std::int64_t>(static_cast<std::size_t>(plan.size()), -1);
  std::map<BatchKey, std::int64_t> numbers;
  std::vector<std::int64_t> out;
  for (const Task& task : plan.tasks()) {
    const TaskSpec spec = plan.spec(task.index);
    const auto next = static_cast<std::int64_t>(numbers.size());
    out.push_back(steps_in_batches(spec) ? numbers.try_emplace(batch_key(spec), next).first->second : -1);
  }
  return out;
}

BatchBody batch_body(const Plan& plan, WriteRecord write) {
  return [&plan, write, alone = one_by_one(task_body(plan, evaluate, write)), sizes = axis_sizes(plan),
          records = std::vector<TaskRecord>()](const std::vector<std::int64_t>& tasks,
                                               const StopRequested& stop) mutable -> std::vector<TaskResult> {
    if (tasks.size() == 1) return alone(tasks, stop);
    records.resize(std::max(records.size(), tasks.size()));  // their memory is used again
    std::vector<TaskRun> runs;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      const Task& task = plan.task(tasks[i]);
      records[i].prepare(task, sizes);
      runs.push_back({&task, plan.spec(tasks[i]), &records[i]});
    }
    std::vector<TaskResult> results(tasks.size());
    if (!evaluate_batch(runs, stop)) return results;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      write(*runs[i].task, records[i]);
      results[i] = {records[i].outcome, records[i].message};
    }
    return results;
  };
}

}  // namespace rodsweep
