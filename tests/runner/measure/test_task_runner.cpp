// An error in a task becomes an outcome in the file; an error while writing, or of the request to stop, does not.
#include <exception>
#include <vector>

#include "runner/measure/task_runner.hpp"
#include "tests/catch.hpp"
#include "tests/runner/data_set_examples.hpp"

namespace rodsweep {
namespace test_task_runner {

bool never() { return false; }

/// A runner of a task of five steps, and what it writes.
struct Run {
  explicit Run(const TaskHooks& hooks = {})
      : plan(plan_of(five_steps(R"(["zero"])"))),
        run(
            plan, [this](const Task&, const TaskRecord& record, const TaskOrigin*) { write(record); }, hooks) {}

  void write(const TaskRecord& record) {
    if (failure) std::rethrow_exception(failure);
    written.push_back(record);
  }

  Plan plan;
  std::vector<TaskRecord> written;
  std::exception_ptr failure;  ///< of the next write
  TaskRunner run;
};

TEST_CASE("a record that was filled is written and its outcome returned") {
  Run made;
  CHECK(made.run(0, never).outcome == TaskOutcome::ok);
  REQUIRE(made.written.size() == 1);
  CHECK(made.written[0].outcome == TaskOutcome::ok);
  CHECK(made.written[0].tasks.steps_done[0] == 5);
}

TEST_CASE("a task that throws is an error with its message, written with the steps up to it") {
  TaskHooks hooks;
  hooks.observe = [](const Rod&, const LinearSystem&, const SolvePosition& at, const VectorX&) {
    if (at.step == 3) throw std::runtime_error("the matrix has no diagonal");
  };
  Run made(hooks);
  const TaskResult result = made.run(0, never);
  CHECK(result.outcome == TaskOutcome::error);
  CHECK(result.message == "the matrix has no diagonal");
  REQUIRE(made.written.size() == 1);
  CHECK(made.written[0].outcome == TaskOutcome::error);
  CHECK(made.written[0].message == "the matrix has no diagonal");
  CHECK(made.written[0].tasks.steps_done[0] == 3);
}

TEST_CASE("an abandoned task is not written; an error of a write or of the request to stop is not the task's outcome") {
  Run made;
  CHECK(made.run(0, [] { return true; }).outcome == TaskOutcome::pending);
  CHECK_THROWS_WITH(made.run(0, []() -> bool { throw std::runtime_error("MPI_Iprobe failed"); }), "MPI_Iprobe failed");
  made.failure = std::make_exception_ptr(std::runtime_error("no space left on device"));
  CHECK_THROWS_WITH(made.run(0, never), "no space left on device");
  CHECK(made.written.empty());
}

TEST_CASE("outcomes of tasks keep the numbers and names that files hold") {
  const char* const names[task_outcomes] = {"pending",         "ok",        "diverged", "not_a_number", "indefinite",
                                            "iteration_limit", "timed_out", "error",    "torn",         "crashed"};
  for (int i = 0; i < task_outcomes; ++i) CHECK(to_string(static_cast<TaskOutcome>(i)) == std::string(names[i]));
}

}  // namespace test_task_runner
}  // namespace rodsweep
