// Jobs of kind "dataset": keys, plan, rows of their systems.
#include <catch2/catch.hpp>

#include "runner/file/record.hpp"
#include "tests/runner/job_examples.hpp"

using namespace rodsweep;

TEST_CASE("a data set is simulated with the direct solve and no guesses") {
  const Plan plan = plan_of(data_job());
  const TaskSpec spec = plan.spec(0);
  CHECK(spec.solve.method == Method::direct);
  CHECK(spec.guesses.empty());
  CHECK(spec.own_guess == -1);
  CHECK(spec.output.solves);
  CHECK(spec.output.systems == StoredSystems::first);
  CHECK(plan.guess_labels().empty());
  CHECK(plan_of(small_job()).spec(0).output.systems == StoredSystems::none);
}

TEST_CASE("rows of systems follow task by task, as many as their rods have segments and joints") {
  Json job = data_job();
  job["scene"]["segments"] = grid({4, 7});
  for (const std::int64_t iterations : {1, 3}) {
    job["record"] = {{"systems", iterations == 1 ? "first" : "all"}};
    const Plan plan = plan_of(job);
    const std::int64_t systems = 4 * iterations;
    CHECK(plan.task(0).rows[Rows::system].count == systems);
    CHECK(plan.task(1).rows[Rows::system].first == systems);
    CHECK(plan.task(1).rows[Rows::system_segment].first == systems * 4);
    CHECK(plan.task(1).rows[Rows::system_joint].first == systems * 3);
    CHECK(plan.rows(Rows::system) == 2 * systems);
    CHECK(plan.rows(Rows::system_segment) == systems * (4 + 7));
    CHECK(plan.rows(Rows::system_joint) == systems * (3 + 6));
    CHECK(plan.task(1).rows[Rows::system_joint].count == systems * 6);

    const Plan alone = plan.alone(1, 1);
    CHECK(alone.task(0).rows[Rows::system_segment].first == 0);
    CHECK(alone.rows(Rows::system_segment) == systems * 7);
  }
}

TEST_CASE("a data set of more rows than any disk holds is refused") {
  Json job = data_job();
  job["scene"]["segments"] = 1000000;
  job["time"] = {{"step_s", 0.02}, {"steps", 10000000}, {"newton_iterations", 1000}};
  job["record"] = {{"systems", "all"}, {"solves", "summary"}};
  CHECK_THAT(refusal(job), Catch::Matchers::Contains("this job is too large"));
}
