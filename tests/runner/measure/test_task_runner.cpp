// An error in a task becomes an outcome in the file; an error while writing, or of the request to stop, does not.
#include <catch2/catch.hpp>
#include <vector>

#include "runner/measure/task_runner.hpp"
#include "tests/runner/data_set_examples.hpp"

namespace rodsweep {
namespace test_task_runner {

bool never() { return false; }

TaskRunner::Write into(std::vector<TaskRecord>& written) {
  return [&written](const Task&, const TaskRecord& record, const TaskOrigin* origin) {
    CHECK(origin == nullptr);
    written.push_back(record);
  };
}

TEST_CASE("a record that was filled is written and its outcome returned") {
  const Plan plan = plan_of(five_steps(R"(["zero"])"));
  std::vector<TaskRecord> written;
  TaskRunner run(plan, into(written));
  CHECK(run(0, never).outcome == TaskOutcome::ok);
  REQUIRE(written.size() == 1);
  CHECK(written[0].outcome == TaskOutcome::ok);
  CHECK(written[0].tasks.steps_done[0] == 5);
}

TEST_CASE("a task that throws is an error with its message, written with the steps up to it") {
  const Plan plan = plan_of(five_steps(R"(["zero"])"));
  std::vector<TaskRecord> written;
  TaskHooks hooks;
  hooks.observe = [](const Rod&, const LinearSystem&, const SolvePosition& at, const VectorX&) {
    if (at.step == 3) throw std::runtime_error("the matrix has no diagonal");
  };
  TaskRunner run(plan, into(written), hooks);
  const TaskResult result = run(0, never);
  CHECK(result.outcome == TaskOutcome::error);
  CHECK(result.message == "the matrix has no diagonal");
  REQUIRE(written.size() == 1);
  CHECK(written[0].outcome == TaskOutcome::error);
  CHECK(written[0].message == "the matrix has no diagonal");
  CHECK(written[0].tasks.steps_done[0] == 3);
}

TEST_CASE("an abandoned task is not written") {
  const Plan plan = plan_of(five_steps(R"(["zero"])"));
  std::vector<TaskRecord> written;
  TaskRunner run(plan, into(written));
  CHECK(run(0, [] { return true; }).outcome == TaskOutcome::pending);
  CHECK(written.empty());
}

TEST_CASE("a failing write is no outcome of the task") {
  const Plan plan = plan_of(five_steps(R"(["zero"])"));
  TaskRunner run(plan, [](const Task&, const TaskRecord&, const TaskOrigin*) {
    throw std::runtime_error("no space left on device");
  });
  CHECK_THROWS_WITH(run(0, never), "no space left on device");
}

TEST_CASE("a failing request to stop is no outcome of the task, which is not written") {
  const Plan plan = plan_of(five_steps(R"(["zero"])"));
  std::vector<TaskRecord> written;
  TaskRunner run(plan, into(written));
  CHECK_THROWS_WITH(run(0, []() -> bool { throw std::runtime_error("MPI_Iprobe failed"); }), "MPI_Iprobe failed");
  CHECK(written.empty());
}

TEST_CASE("outcomes of tasks keep the numbers and names that files hold") {
  const char* const names[task_outcomes] = {"pending",         "ok",        "diverged", "not_a_number", "indefinite",
                                            "iteration_limit", "timed_out", "error",    "torn",         "crashed"};
  for (int i = 0; i < task_outcomes; ++i) CHECK(to_string(static_cast<TaskOutcome>(i)) == std::string(names[i]));
}

}  // namespace test_task_runner
}  // namespace rodsweep
