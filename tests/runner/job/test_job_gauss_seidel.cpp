// Jobs with Gauss-Seidel instead of linear solves.
#include <catch2/catch.hpp>

#include "tests/runner/job_examples.hpp"

namespace rodsweep {
namespace test_job_gauss_seidel {

Json by(const std::string& solve) {
  return with("/evaluation", "\"closed_loop\"", with("/solve", solve, without("/guesses")));
}

TEST_CASE("pbd and xpbd count their own iterations, in a trajectory without guesses") {
  Json job = by(R"({"grid": [{"method": "xpbd", "iterations": 30}, {"method": "pbd", "stretch_stiffness": 0.9},
                             {"method": "direct"}]})");
  job["time"]["newton_iterations"] = 4;
  const Plan plan = plan_of(job);
  REQUIRE(plan.size() == 3);
  CHECK(plan.spec(0).solve.method == Method::xpbd);
  CHECK(plan.spec(0).time.newton_iterations == 30);
  CHECK(plan.task(0).rows[Rows::solve].count == 30 * plan.task(0).steps);
  CHECK(plan.spec(1).solve.method == Method::pbd);
  CHECK(plan.spec(1).time.newton_iterations == 20);
  CHECK(plan.spec(1).solve.stiffness.stretch == 0.9);
  CHECK(plan.spec(1).solve.stiffness.bending == 1);
  CHECK(plan.spec(2).time.newton_iterations == 4);
  CHECK(plan.task(2).rows[Rows::solve].count == 4 * plan.task(2).steps);
  for (const Task& task : plan.tasks()) {
    CHECK(task.own_guess == -1);
    CHECK(plan.spec(task.index).guesses.empty());
  }
  CHECK(plan.task(0).cost == 7.5 * plan.task(2).cost);
}

TEST_CASE("of a grid of methods, those of Gauss-Seidel have their defaults too") {
  const Plan plan = plan_of(by(R"({"method": {"grid": ["xpbd", "pbd", "direct"]}})"));
  CHECK(plan.spec(0).time.newton_iterations == 20);
  CHECK(plan.spec(1).time.newton_iterations == 20);
  CHECK(plan.spec(1).solve.stiffness.stretch == 1);
  CHECK(plan.spec(2).time.newton_iterations == 6);
}

TEST_CASE("iterations and stiffness are part of what a trajectory is") {
  const auto trajectory = [](const std::string& solve) { return plan_of(by(solve)).inputs(0).trajectory; };
  CHECK(trajectory(R"({"method": "xpbd"})") == trajectory(R"({"method": "xpbd", "iterations": 20})"));
  CHECK(trajectory(R"({"method": "xpbd"})") != trajectory(R"({"method": "xpbd", "iterations": 21})"));
  CHECK(trajectory(R"({"method": "pbd"})") != trajectory(R"({"method": "pbd", "bending_stiffness": 0.5})"));
}

}  // namespace test_job_gauss_seidel
}  // namespace rodsweep
