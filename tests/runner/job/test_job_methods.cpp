// The methods that advance rods, and data sets: what their tasks have. tests/laws/every_preconditioner.cpp runs them.

#include "tests/catch.hpp"
#include "tests/runner/job_examples.hpp"

namespace rodsweep {
namespace test_job_methods {

/// A closed loop of the small job.
Json loop(const std::string& solve, Json job = small_job()) {
  return with("/evaluation", "\"closed_loop\"", with("/solve", solve, std::move(job)));
}

TEST_CASE("all methods stand side by side in one closed loop, and only cg has guesses") {
  Json job = loop(R"({"grid": [{"method": "xpbd", "iterations": 30}, {"method": "pbd", "stretch_stiffness": 0.9},
                               {"method": "end_to_end", "model": ")" PRETRAINED
                  R"(/rods.h5"}, {"method": "direct"}, {}]})");
  job["time"]["newton_iterations"] = 4;
  const Plan plan = plan_of(job);
  REQUIRE(plan.size() == 4 + 2);
  const Method methods[] = {Method::xpbd, Method::pbd, Method::end_to_end, Method::direct, Method::cg, Method::cg};
  const int iterations[] = {30, 20, 4, 4, 4, 4};  // pbd and xpbd count their own
  for (const Task& task : plan.tasks()) {
    CAPTURE(task.index);
    const TaskSpec spec = plan.spec(task.index);
    const bool is_cg = task.index >= 4;
    CHECK(spec.solve.method == methods[task.index]);
    CHECK(spec.guesses.size() == (is_cg ? 2 : 0));
    CHECK(task.own_guess == (is_cg ? task.index - 4 : -1));
    CHECK(spec.time.newton_iterations == iterations[task.index]);
    CHECK(task.rows[Rows::solve].count == iterations[task.index] * task.steps);
  }
  CHECK(plan.spec(1).solve.stiffness.stretch == 0.9);
  CHECK(plan.spec(1).solve.stiffness.bending == 1);
  CHECK(std::filesystem::equivalent(plan.spec(2).solve.model, PRETRAINED "/rods.h5"));
  CHECK(plan.task(0).cost == 7.5 * plan.task(3).cost);
}

TEST_CASE("of a grid of methods, those of Gauss-Seidel have their defaults too") {
  const Plan plan = plan_of(loop(R"({"method": {"grid": ["xpbd", "pbd", "direct"]}})", without("/guesses")));
  CHECK(plan.spec(0).time.newton_iterations == 20);
  CHECK(plan.spec(1).time.newton_iterations == 20);
  CHECK(plan.spec(1).solve.stiffness.stretch == 1);
  CHECK(plan.spec(2).time.newton_iterations == TimeSpec{}.newton_iterations);
}

TEST_CASE("a data set is simulated with the direct solve and no guesses, and keeps its systems") {
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

TEST_CASE("data sets have what the balance is kept against, where any task keeps it") {
  for (const char* balance : {"false", "true", R"({"grid": [false, true]})"}) {
    const Plan plan = plan_of(with("/time/balance", balance, data_job()));
    for (const Task& task : plan.tasks())
      CHECK(task.rows[Rows::balanced_segment].count ==
            (balance == std::string("false") ? 0 : task.rows[Rows::system_segment].count));
  }
}

}  // namespace test_job_methods
}  // namespace rodsweep
