// An error in a task becomes an outcome in the file; an error while writing does not.
#include <catch2/catch.hpp>
#include <vector>

#include "runner/measure/task_body.hpp"
#include "tests/runner/job_examples.hpp"

using namespace rodsweep;

namespace test_task_body {

bool never() { return false; }

WriteRecord into(std::vector<TaskRecord>& written) {
  return [&written](const Task&, const TaskRecord& record, const TaskOrigin* origin) {
    CHECK(origin == nullptr);
    written.push_back(record);
  };
}

TEST_CASE("a record that was filled is written and its outcome returned") {
  const Plan plan = plan_of(small_job());
  std::vector<TaskRecord> written;
  TaskBody body =
      task_body(plan, into(written), [](const Task&, const TaskSpec& spec, TaskRecord& record, const StopRequested&) {
        record.outcome = TaskOutcome::diverged;
        record.message = "joint gap 12";
        record.tasks.steps_done[0] = spec.time.steps;
        return true;
      });
  const TaskResult result = body(0, never);
  CHECK(result.outcome == TaskOutcome::diverged);
  CHECK(result.message == "joint gap 12");
  REQUIRE(written.size() == 1);
  CHECK(written[0].outcome == TaskOutcome::diverged);
  CHECK(written[0].tasks.steps_done[0] == 10);
}

TEST_CASE("a task that throws is an error with its message, written with sentinels") {
  const Plan plan = plan_of(small_job());
  std::vector<TaskRecord> written;
  TaskBody body = task_body(plan, into(written),
                            [](const Task&, const TaskSpec&, TaskRecord& record, const StopRequested&) -> bool {
                              record.tasks.steps_done[0] = 3;
                              throw std::runtime_error("the matrix has no diagonal");
                            });
  CHECK(body(0, never).outcome == TaskOutcome::error);
  REQUIRE(written.size() == 1);
  CHECK(written[0].outcome == TaskOutcome::error);
  CHECK(written[0].message == "the matrix has no diagonal");
  CHECK(written[0].tasks.steps_done[0] == -1);
}

TEST_CASE("an abandoned task is not written") {
  const Plan plan = plan_of(small_job());
  std::vector<TaskRecord> written;
  TaskBody body =
      task_body(plan, into(written),
                [](const Task&, const TaskSpec&, TaskRecord&, const StopRequested& stop) { return !stop(); });
  CHECK(body(0, [] { return true; }).outcome == TaskOutcome::pending);
  CHECK(written.empty());
}

TEST_CASE("a failing write is no outcome of the task") {
  const Plan plan = plan_of(small_job());
  TaskBody body = task_body(
      plan,
      [](const Task&, const TaskRecord&, const TaskOrigin*) { throw std::runtime_error("no space left on device"); },
      [](const Task&, const TaskSpec&, TaskRecord&, const StopRequested&) { return true; });
  CHECK_THROWS_WITH(body(0, never), "no space left on device");
}

TEST_CASE("outcomes of tasks keep the numbers and names that files hold") {
  const char* const names[task_outcomes] = {"pending",         "ok",        "diverged", "not_a_number", "indefinite",
                                            "iteration_limit", "timed_out", "error",    "torn",         "crashed"};
  for (int i = 0; i < task_outcomes; ++i) CHECK(to_string(static_cast<TaskOutcome>(i)) == std::string(names[i]));
}

}  // namespace test_task_body
