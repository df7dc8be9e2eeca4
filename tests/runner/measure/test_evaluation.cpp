// Evaluation of one task: counters, for guesses of known quality.
#include <algorithm>
#include <cmath>
#include <functional>

#include "runner/measure/measured_solve.hpp"
#include "runner/measure/run_task.hpp"
#include "solver/step/time_step.hpp"
#include "tests/catch.hpp"
#include "tests/hand_clock.hpp"
#include "tests/runner/data_set_examples.hpp"

namespace rodsweep {
namespace test_evaluation {

/// The record of the job's only task.
TaskRecord evaluated(const Json& job, TaskOutcome expected = TaskOutcome::ok,
                     TimeSource now = std::chrono::steady_clock::now) {
  const Plan plan = plan_of(job);
  REQUIRE(plan.size() == 1);
  TaskRecord record;
  record.prepare(plan.task(0), axis_sizes(plan));
  REQUIRE(run_task(plan.task(0), plan.spec(0), record, {now}));
  INFO(record.message);
  CHECK(record.outcome == expected);
  return record;
}

constexpr std::size_t tolerances = 8;

std::int64_t solves_of(const TaskRecord& r) { return static_cast<std::int64_t>(rows_run(r).size()); }

TEST_CASE("an exact guess takes no iteration, one product with the matrix for each solve, and has ratio 0") {
  const TaskRecord r = evaluated(five_steps(R"(["zero", {"oracle": {"error": 0}}])"));
  for (std::size_t t = 0; t < tolerances; ++t) {
    CHECK(r.tasks.counted.cg_ratio[t] == 1);
    CHECK(r.tasks.counted_all.matvecs[t] == r.tasks.counted_all.iterations[t]);  // from zero, b is the first residual
    CHECK(r.tasks.counted_all.iterations[t] > 0);
  }
  for (std::size_t t = 0; t < 7; ++t) {  // at 1e-8, the tightest, rounding may cost an iteration
    CHECK(r.tasks.counted_all.cg_ratio[tolerances + t] == 0);
    CHECK(r.tasks.counted_other_norm.cg_ratio[tolerances + t] == 0);
    CHECK(r.tasks.counted_all.matvecs[tolerances + t] == solves_of(r));
  }
}

/// The steps that are logged of a task that is cancelled as soon as `stop` says so.
std::int32_t steps_until(const Json& job, const std::function<bool(const TaskRecord&)>& stop) {
  const Plan plan = plan_of(job);
  TaskRecord record;
  record.prepare(plan.task(0), axis_sizes(plan));
  const auto asked = [&] { return stop(record); };
  CHECK_FALSE(run_task(plan.task(0), plan.spec(0), record, {test::HandClock::ticking, asked}));
  return record.tasks.steps_done[0];
}

TEST_CASE("a time limit and a stop are met in the middle of a solve") {
  Json job = with("/scene/segments", "300", five_steps(R"(["zero"])", R"({"reference": "cg"})"));
  const auto looks_of_one_step = [&] {  // at the clock, which advances by a second per call
    Json one = job;
    one["time"]["steps"] = 1;
    one["task_time_limit_s"] = 1e9;
    const TimePoint begin = test::HandClock::now();
    evaluated(one, TaskOutcome::ok, test::HandClock::ticking);
    return std::chrono::duration<double>(test::HandClock::now() - begin).count();
  };
  test::HandClock::set_tick(std::chrono::seconds(1));
  int asked = 0;  // after set-up
  CHECK(steps_until(job, [&](const TaskRecord& r) { return r.tasks.steps_done[0] == 0 && ++asked > 2; }) == 0);
  job["task_time_limit_s"] = looks_of_one_step() - 3;
  const TaskRecord late = evaluated(job, TaskOutcome::timed_out, test::HandClock::ticking);
  CHECK(late.tasks.steps_done[0] == 0);
  CHECK_THAT(late.message, Catch::Matchers::StartsWith("step 0: the time limit of"));
}

TEST_CASE("a time limit and a stop are met while scene and systems are built") {
  Json job = with("/scene/segments", "20000", five_steps(R"(["zero"])"));
  test::HandClock::set_tick(std::chrono::seconds(1));
  CHECK(steps_until(job, [](const TaskRecord&) { return true; }) == -1);  // too early for a log entry
  job["task_time_limit_s"] = 0.5;
  const TaskRecord late = evaluated(job, TaskOutcome::timed_out, test::HandClock::ticking);
  CHECK(late.tasks.steps_done[0] == 0);
  CHECK_THAT(late.message, Catch::Matchers::StartsWith("step 0: the time limit of 0.5 s") &&
                               Catch::Matchers::ContainsSubstring("task_time_limit_s"));
  CHECK(std::isnan(late.steps.length_drift[0]));
}

TEST_CASE("with CG as the reference the counts are those beside the direct solve, which is not run") {
  for (const char* guesses : {R"(["zero", "previous", "quadratic"])", R"(["previous", "zero"])"}) {
    const TaskRecord direct = evaluated(five_steps(guesses));
    const TaskRecord by_cg = evaluated(five_steps(guesses, R"({"reference": "cg"})"));
    const std::size_t guess_count = by_cg.timing.cg_s.size() / by_cg.solves.newton.size();
    CHECK(by_cg.solves.newton == direct.solves.newton);
    CHECK(by_cg.tasks.counted.iterations.size() == direct.tasks.counted.iterations.size());
    for (std::size_t i = 0; i < by_cg.tasks.counted_all.iterations.size(); ++i)
      CHECK(std::abs(by_cg.tasks.counted_all.iterations[i] - direct.tasks.counted_all.iterations[i]) <=
            2 + direct.tasks.counted_all.iterations[i] / 50);
    for (std::size_t row = 0; row < by_cg.solves.newton.size(); ++row) {
      CHECK(std::isnan(by_cg.timing.direct_s[row]));
      CHECK(std::isnan(direct.timing.direct_s[row]) == (direct.solves.newton[row] < 0));
      CHECK(std::isnan(by_cg.timing.cg_s[row * guess_count]) == (by_cg.solves.newton[row] < 0));
    }
  }
}

TEST_CASE("with CG as the reference a closed loop is what it is beside the direct solve, bit by bit") {
  Json job = five_steps(R"(["zero"])");
  job["evaluation"] = "closed_loop";
  const TaskRecord direct = evaluated(job);
  job["solve"]["reference"] = "cg";
  const TaskRecord by_cg = evaluated(job);
  CHECK(by_cg.solves.iterations == direct.solves.iterations);
  CHECK(by_cg.solves.newton == direct.solves.newton);
  for (const std::size_t row : rows_run(by_cg))
    CHECK(by_cg.solves.final_residual[row] == direct.solves.final_residual[row]);
  CHECK(std::all_of(by_cg.timing.direct_s.begin(), by_cg.timing.direct_s.end(), [](float s) { return std::isnan(s); }));
}

TEST_CASE("a reference that runs out of iterations advances the rod all the same, and its task says so") {
  const TaskRecord r = evaluated(five_steps(R"(["zero"])", R"({"reference": "cg", "max_iterations": 12})"),
                                 TaskOutcome::iteration_limit);
  CHECK(r.tasks.counted_all.unreached.back() > 0);
  CHECK(r.tasks.steps_done.front() == 5);
}

TEST_CASE("sums are those of the rows, of first Newton iterations and of all") {
  const TaskRecord r =
      evaluated(five_steps(R"(["zero", "previous", {"guarded": {"guess": "linear", "threshold": 1}}])"));
  REQUIRE(solves_of(r) > 5);
  for (std::size_t g = 0; g < 3; ++g)
    for (std::size_t t = 0; t < tolerances; ++t) {
      std::int64_t first = 0, all = 0, matvecs = 0;
      for (const std::size_t row : rows_run(r)) {
        const int iterations = r.solves.iterations[(3 * row + g) * tolerances + t];
        REQUIRE(iterations >= 0);
        all += iterations;
        matvecs += iterations + r.solves.start_matvecs[3 * row + g];
        if (r.solves.newton[row] == 0) first += iterations;
      }
      CHECK(r.tasks.counted.iterations[g * tolerances + t] == first);
      CHECK(r.tasks.counted_all.iterations[g * tolerances + t] == all);
      CHECK(r.tasks.counted_all.matvecs[g * tolerances + t] == matvecs);
    }
}

TEST_CASE("the other norm's counts are those of a job in that norm") {
  const std::string guesses = R"(["zero", "previous", {"subspace": {"size": 3}}])";
  const TaskRecord in_2_norm = evaluated(five_steps(guesses));
  const TaskRecord in_natural = evaluated(five_steps(guesses, R"({"norm": "natural"})"));
  CHECK(in_2_norm.tasks.counted_other_norm.iterations == in_natural.tasks.counted.iterations);
  CHECK(in_natural.tasks.counted_other_norm.iterations == in_2_norm.tasks.counted.iterations);
  CHECK(in_2_norm.tasks.counted.iterations != in_natural.tasks.counted.iterations);
  const TaskRecord bare = evaluated(five_steps(guesses, R"({"preconditioner": "none", "max_iterations": 2000})"));
  for (std::size_t t = 0; t < 2; ++t)  // equal norms without P; later, rounding makes unpreconditioned CG erratic
    CHECK(bare.tasks.counted_other_norm.iterations[t] == bare.tasks.counted.iterations[t]);
}

TEST_CASE("the other norm has no counts where a job wants none, or a condensed system has one norm") {
  Json job = five_steps(R"(["zero", "previous"])");
  job["scene"] = Json::parse(R"({"type": "lattice", "nodes_x": 2, "mesh_m": 0.2, "segments": 2, "radius_m": 0.01,
                                 "density_kg_m3": 1000, "youngs_modulus_pa": 1e6, "torsion_modulus_pa": 4e5})");
  const TaskRecord both = evaluated(job), one = evaluated(with("/record/norms", "\"one\"", job)),
                   condensed = evaluated(with("/solve/preconditioner", "\"condensed\"", job));
  for (std::size_t i = 0; i < both.tasks.counted_other_norm.iterations.size(); ++i) {
    CHECK(both.tasks.counted_other_norm.iterations[i] > 0);
    CHECK(one.tasks.counted_other_norm.iterations[i] == -1);
    CHECK(condensed.tasks.counted_other_norm.iterations[i] == -1);
  }
  for (const std::size_t row : rows_run(condensed)) {
    for (std::size_t t = 0; t < 4; ++t)
      CHECK(condensed.solves.iterations[2 * row * tolerances + t] <= both.solves.iterations[2 * row * tolerances + t]);
    CHECK(condensed.solves.initial_residual[2 * row + 1] == Approx(both.solves.initial_residual[2 * row + 1]));
  }
}

TEST_CASE("lag_steps keeps any preconditioner: set up for every system, a step, or some of them") {
  const auto at = [](int lag_steps) {
    return evaluated(five_steps(R"(["zero"])", R"({"preconditioner": "block_icc", "fill_levels": 0, "lag_steps": )" +
                                                   std::to_string(lag_steps) + "}"));
  };
  const TaskRecord anew = at(0), a_step = at(1), two = at(2);
  for (const std::size_t row : rows_run(anew)) {
    const int first = anew.solves.newton[row] == 0, even = anew.solves.step[row] % 2 == 0;
    CHECK(anew.solves.renewed[row] == 0);
    CHECK(a_step.solves.renewed[row] == first);
    CHECK(two.solves.renewed[row] == (first && even));
    const auto iterations = [&](const TaskRecord& r) { return r.solves.iterations[row * tolerances + 2]; };
    CHECK(iterations(anew) <= 1);
    if (first) CHECK(iterations(a_step) == iterations(anew));
    if (first && even) CHECK(iterations(two) == iterations(anew));
  }
  const auto all = [](const TaskRecord& r) { return r.tasks.counted_all.iterations[2]; };
  CHECK(all(anew) < all(a_step));
  CHECK(all(a_step) < all(two));
}

TEST_CASE("a closed loop advances by its own guess's solution, at the job's tolerance") {
  Json job = five_steps(R"(["zero"])", R"({"tolerance": 0.5})");
  job["time"]["newton_iterations"] = 3;
  const TaskRecord paired = evaluated(job);
  job["evaluation"] = "closed_loop";
  const TaskRecord loose = evaluated(job);
  job["solve"]["tolerance"] = 1e-10;
  const TaskRecord tight = evaluated(job);
  CHECK(loose.steps.joint_gap[4] > 100 * paired.steps.joint_gap[4]);
  CHECK(tight.trajectories.position_m == paired.trajectories.position_m);
  CHECK(tight.steps.kinetic_energy_j[4] == Approx(paired.steps.kinetic_energy_j[4]).epsilon(1e-6));
}

TEST_CASE("a guess that no solve can start from fails the task by its name, and is not counted as zero iterations") {
  const Plan plan = plan_of(five_steps(R"(["zero", {"oracle": {"error": 1e6}}, "previous"])"));
  const TaskSpec spec = plan.spec(0);
  TaskRecord record;
  record.prepare(plan.task(0), axis_sizes(plan));
  Scene scene = build_scene(spec.scene);
  Rod& rod = scene.rods.front();
  rod.position.back().x() = 1e150;  // the norm of a vector a million times as large overflows
  LinearSystem system(rod);
  system.assemble(rod, constraint_dt(scene, spec.time.step_s));
  MeasuredSolve solve(scene, spec, record);
  VectorX delta_lambda = VectorX::Zero(system.rhs().size());
  CHECK(solve.solve(system, {0, 0, 0}, 0, delta_lambda) == SolveOutcome::not_a_number);
  solve.finish();
  CHECK(record.message == ": it cannot start from the guess \"oracle 1000000.0\"");
  CHECK(record.solves.outcome[0] != static_cast<int>(SolveOutcome::not_a_number));
  CHECK(record.solves.outcome[1] == static_cast<int>(SolveOutcome::not_a_number));
  CHECK(record.solves.outcome[2] == static_cast<int>(SolveOutcome::not_run));
  CHECK(std::isnan(record.solves.initial_residual[1]));
  for (std::size_t t = 0; t < tolerances; ++t) {
    CHECK(record.solves.iterations[tolerances + t] == -1);
    CHECK(record.tasks.counted.matvecs[t] > 0);
    CHECK(record.tasks.counted.unreached[tolerances + t] == 0);
  }
}

TEST_CASE("the joint gap before a step's first solve is not that of the step before: the rod has moved by itself") {
  const TaskRecord r = evaluated(five_steps(R"(["zero"])"));
  for (std::size_t row = 0; row < r.solves.newton.size(); ++row)
    if (r.solves.newton[row] > 0) CHECK(r.solves.joint_gap[row] < 0.5 * r.solves.joint_gap[row - 1]);
  CHECK(r.solves.joint_gap[0] > 1e-6);
}

}  // namespace test_evaluation
}  // namespace rodsweep
