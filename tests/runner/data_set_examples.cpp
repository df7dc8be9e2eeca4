#include "tests/runner/data_set_examples.hpp"

#include <stdexcept>

#include "runner/experiment/evaluation.hpp"

namespace rodsweep {

TaskRecord record_of(const Plan& plan, std::int64_t index) {
  const Task task = plan.task(index);
  TaskRecord record;
  record.prepare(task, axis_sizes(plan));
  if (!evaluate(task, plan.spec(index), record, [] { return false; })) throw std::logic_error("abandoned");
  return record;
}

Plan make_data_set(const std::filesystem::path& path, const Json& job, std::int64_t failing, bool pending) {
  const Plan plan = plan_of(job);
  ResultsFile file = ResultsFile::create(path, plan, test_provenance(), MPI_COMM_SELF);
  for (const Task& task : plan.tasks()) {
    if (pending && task.index >= failing) continue;
    TaskRecord record = record_of(plan, task.index);
    if (task.index >= failing) record.outcome = TaskOutcome::diverged, record.message = "step 2: too bad";
    file.write(task, record);
  }
  file.close();
  return plan;
}

}  // namespace rodsweep
