// Which tasks a run has to do: each filter over the list of tasks.
#include <limits>

#include "runner/command/sweep_opening.hpp"
#include "tests/catch.hpp"
#include "tests/runner/job_examples.hpp"

using namespace rodsweep;

namespace test_sweep_tasks {

/// Four tasks; task 3 costs most.
Plan four_tasks() { return plan_of(with("/scene/segments", R"({"grid": [10, 20, 30, 40]})", small_job())); }

std::vector<std::int64_t> indices(const std::vector<PendingTask>& tasks) {
  std::vector<std::int64_t> found;
  for (const PendingTask& task : tasks) found.push_back(task.index);
  return found;
}

/// The tasks that pass the filter.
std::vector<std::int64_t> passing(std::vector<PendingTask> tasks, const TaskFilter& filter) {
  leave_out(tasks, filter);
  return indices(tasks);
}

using Indices = std::vector<std::int64_t>;

TEST_CASE("the list begins with all tasks of the plan, with their costs and earlier crashes") {
  const Plan plan = four_tasks();
  const std::vector<PendingTask> tasks = all_tasks(plan, {0, 2, 0, 1}, std::nullopt);
  CHECK(indices(tasks) == Indices{0, 1, 2, 3});
  CHECK(tasks[1].crashes == 2);
  CHECK(tasks[3].cost == plan.cost(3));
}

TEST_CASE("a filter splits the list into tasks that stay and tasks left out, both in order") {
  const Plan plan = four_tasks();
  std::vector<PendingTask> tasks = all_tasks(plan, {0, 0, 0, 0}, std::nullopt);
  const std::vector<std::uint8_t> done{1, 0, 1, 0};
  CHECK(indices(leave_out(tasks, not_done(done))) == Indices{0, 2});
  CHECK(indices(tasks) == Indices{1, 3});
}

TEST_CASE("a task that crashed in each allowed try is left out") {
  CHECK(passing(all_tasks(four_tasks(), {0, 2, 3, 4}, std::nullopt), not_crashed(3)) == Indices{0, 1});
}

TEST_CASE("shards have each task once, dealt out by descending cost") {
  const Plan plan = four_tasks();
  const std::vector<PendingTask> all = all_tasks(plan, {0, 0, 0, 0}, std::nullopt);
  CHECK(passing(all, in_shard(plan, Shard{1, 2})) == Indices{1, 3});
  CHECK(passing(all, in_shard(plan, Shard{2, 2})) == Indices{0, 2});
  CHECK(passing(all, in_shard(plan, Shard{5, 5})).empty());
  CHECK(passing(all, in_shard(plan, std::nullopt)).size() == 4);
}

TEST_CASE("tasks whose results exceed the memory are left out, and the largest of them is named") {
  const Plan plan = four_tasks();
  std::vector<PendingTask> tasks = all_tasks(plan, {0, 0, 0, 0}, std::nullopt);
  const auto bytes = [&](std::int64_t task) { return record_bytes(plan.task(task), row_bytes(axis_sizes(plan))); };
  REQUIRE(bytes(0) == bytes(3));  // small_job() records solves and steps, whose rows do not depend on segments
  CHECK(passing(tasks, fits_memory(plan, static_cast<double>(bytes(0)))).size() == 4);
  CHECK(passing(tasks, fits_memory(plan, std::numeric_limits<double>::infinity())).size() == 4);

  const TooLarge found = largest_of(leave_out(tasks, fits_memory(plan, static_cast<double>(bytes(0)) - 1)), plan);
  CHECK(tasks.empty());
  CHECK(found.tasks == 4);
  CHECK(found.task == 0);
  CHECK(found.bytes == bytes(0));
  CHECK(largest_of({}, plan).tasks == 0);
}

}  // namespace test_sweep_tasks
