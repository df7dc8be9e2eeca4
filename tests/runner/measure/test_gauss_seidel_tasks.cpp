// Whole tasks by Gauss-Seidel: their records, compared with those of the direct solve.
#include <cmath>

#include "tests/catch.hpp"
#include "tests/runner/data_set_examples.hpp"

namespace rodsweep {
namespace test_gauss_seidel_tasks {

TaskRecord evaluated(const std::string& solve, Json job = small_job()) {
  job.erase("guesses");
  job["evaluation"] = "closed_loop";
  job["solve"] = Json::parse(solve);
  return record_of(plan_of(job));
}

TEST_CASE("a task of xpbd holds the residual of every iteration, and the state and time of every step") {
  const TaskRecord record = evaluated(R"({"method": "xpbd", "iterations": 30})");
  REQUIRE(record.outcome == TaskOutcome::ok);
  REQUIRE(record.solves.newton_residual.size() == 10 * 30);
  for (std::size_t row = 0; row < record.solves.newton.size(); ++row) {
    CHECK(record.solves.step[row] == static_cast<int>(row) / 30);
    CHECK(record.solves.newton[row] == static_cast<int>(row) % 30);
  }
  for (std::size_t step = 0; step < 10; ++step) {
    CHECK(record.solves.newton_residual[30 * step + 29] < record.solves.newton_residual[30 * step]);
    CHECK(record.steps.newton_iterations[step] == 30);
    CHECK(record.timing.rest_s[step] > 0);
    CHECK(record.steps.joint_gap[step] > 0);
  }
  CHECK(std::isnan(record.solves.rhs_norm.front()));
  CHECK(std::isnan(record.timing.assemble_s.front()));
  CHECK(record.solves.iterations.empty());
}

TEST_CASE("every tree of a forest takes the steps of the direct solve under xpbd, and sags under pbd too") {
  Json job = small_job();
  job["scene"] = forest_scene();
  job["time"] = {{"step_s", 0.002}, {"steps", 5}, {"newton_tolerance", 1e-10}};
  const TaskRecord direct = evaluated(R"({"method": "direct"})", job);
  const TaskRecord xpbd = evaluated(R"({"method": "xpbd", "iterations": 3000})", job);
  const TaskRecord pbd = evaluated(R"({"method": "pbd", "iterations": 20})", job);
  REQUIRE(direct.outcome == TaskOutcome::ok);
  REQUIRE(xpbd.outcome == TaskOutcome::ok);
  REQUIRE(pbd.outcome == TaskOutcome::ok);
  for (std::size_t step = 0; step < 5; ++step) {
    CHECK(xpbd.steps.kinetic_energy_j[step] == Approx(direct.steps.kinetic_energy_j[step]).epsilon(1e-3));
    CHECK(pbd.steps.kinetic_energy_j[step] > 0);
    CHECK(pbd.steps.joint_gap[step] < 1e-2);
  }
  for (std::size_t rod = 0; rod < 2; ++rod) {
    CHECK(pbd.solves.rod[rod] == static_cast<int>(rod));
    CHECK(pbd.solves.newton_residual[rod] > 0);
  }
}

TEST_CASE("summaries of Gauss-Seidel have steps and no rows of iterations") {
  const TaskRecord record = evaluated(R"({"method": "pbd"})", with("/record", R"({"solves": "summary"})"));
  CHECK(record.outcome == TaskOutcome::ok);
  CHECK(record.solves.newton_residual.empty());
  CHECK(record.steps.newton_residual.back() > 0);
}

}  // namespace test_gauss_seidel_tasks
}  // namespace rodsweep
