#include "runner/experiment/task_body.hpp"

#include <exception>
#include <utility>

namespace rodsweep {

TaskBody task_body(const Plan& plan, Evaluate evaluate, WriteRecord write) {
  return [&plan, evaluate = std::move(evaluate), write = std::move(write), sizes = axis_sizes(plan),
          record = TaskRecord()](std::int64_t index, const StopRequested& stop) mutable -> TaskResult {
    const Task& task = plan.task(index);
    record.prepare(task, sizes);
    try {
      if (!evaluate(task, plan.spec(index), record, stop)) return {};
    } catch (const std::exception& error) {
      record.prepare(task, sizes);
      record.outcome = TaskOutcome::error;
      record.message = error.what();
    }
    write(task, record);
    return {record.outcome, record.message};
  };
}

}  // namespace rodsweep
