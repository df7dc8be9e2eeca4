// Core-hours estimated by probes with a known evaluation time.

#include "runner/command/plan_estimate.hpp"
#include "tests/catch.hpp"
#include "tests/runner/job_examples.hpp"

using namespace rodsweep;

namespace test_plan_estimate {

/// Pretends that the requested steps take `seconds_per_cost` per unit of Task::cost.
RunTask taking(double seconds_per_cost) {
  return [=](const Task& task, const TaskSpec& spec, TaskRecord& record, const TaskHooks&) {
    record.outcome = TaskOutcome::ok;
    record.tasks.steps_done[0] = spec.time.steps;
    record.timing.elapsed_s[0] = seconds_per_cost * task.segments * spec.time.steps * spec.time.newton_iterations;
    return true;
  };
}

double all_cost(const Plan& plan) {
  double cost = 0;
  for (const Task& task : plan.tasks()) cost += task.cost;
  return cost;
}

TEST_CASE("the cheapest, the median and the dearest task are tried") {
  const Plan plan = plan_of(with("/scene/segments", R"({"grid": [50, 10, 20, 30, 40]})"));
  const auto probes = probe(plan, taking(1e-9));
  REQUIRE(probes.size() == 3);
  CHECK(probes[0].task == 1);
  CHECK(probes[1].task == 3);
  CHECK(probes[2].task == 0);
}

TEST_CASE("a plan of one task is tried once") { CHECK(probe(plan_of(small_job()), taking(1e-9)).size() == 1); }

TEST_CASE("when time is proportional to cost the estimate is exact, also from truncated tasks") {
  const double seconds_per_cost = GENERATE(1e-9, 1e-3);
  const Plan plan = plan_of(with("/time/steps", "1000", with("/scene/segments", R"({"grid": [10, 20, 30, 40]})")));
  const auto probes = probe(plan, taking(seconds_per_cost));
  const Estimate needs = estimate(plan, probes);
  CHECK(needs.core_s == Approx(seconds_per_cost * all_cost(plan)));
  CHECK(needs.longest == 3);
  CHECK(needs.longest_s == Approx(seconds_per_cost * plan.task(3).cost));
  CHECK(needs.wall_s(2) == Approx(needs.core_s / 2));
  CHECK(needs.wall_s(1000) == needs.longest_s);
  CHECK(needs.tasks_per_s(2) == Approx(4 / needs.wall_s(2)));
  if (seconds_per_cost > 1e-6) {
    CHECK(probes.back().steps < 1000);
    CHECK(probes.back().of_steps == 1000);
  } else {
    CHECK(probes.back().steps == 1000);
  }
}

TEST_CASE("no shard's master hands out more than half of what it can") {
  CHECK(shards_for(0.1) == 1);
  CHECK(shards_for(0.5 * master_tasks_per_s) == 1);
  CHECK(shards_for(0.51 * master_tasks_per_s) == 2);
  const double wanted = GENERATE(3e3, 2e4, 1e6);
  CHECK(wanted / shards_for(wanted) <= master_tasks_per_s / 2);
}

TEST_CASE("a probe that fails says so and is extrapolated from the steps that it took") {
  const Plan plan = plan_of(with("/time/steps", "100"));
  const auto probes = probe(plan, [](const Task&, const TaskSpec&, TaskRecord& record, const TaskHooks&) {
    record.outcome = TaskOutcome::diverged;
    record.message = "joint gap 12";
    record.tasks.steps_done[0] = 2;
    record.timing.elapsed_s[0] = 0.5;
    return true;
  });
  CHECK(probes.at(0).outcome == TaskOutcome::diverged);
  CHECK(probes.at(0).message == "joint gap 12");
  CHECK(probes.at(0).seconds == Approx(25));
}

}  // namespace test_plan_estimate
