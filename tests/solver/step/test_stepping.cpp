// Control flow of a time step: convergence of Newton, limits, failures, several rods, refusals.
#include <limits>
#include <string>
#include <vector>

#include "solver/step/observables.hpp"
#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/stepping.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_stepping {

/// Solves directly and counts its calls, but reports another outcome at one position.
auto failing(DirectSolve& direct, const SolvePosition& where, SolveOutcome outcome, int& calls) {
  return SolveBy([&direct, where, outcome, &calls](const LinearSystem& system, const SolvePosition& at, VectorX& x) {
    ++calls;
    const SolveOutcome found = direct.solve(system, at, 0, x);
    return at.step == where.step && at.newton == where.newton && at.rod == where.rod ? outcome : found;
  });
}

TEST_CASE("Newton ends below its tolerance, and the step says how many solves that took") {
  Scene scene = test::moving_scene(10);
  DirectSolve direct(scene);
  LinearProjection projection(scene, direct);
  test::Recorder recorder(projection);
  TimeStepper stepper(scene, {0.02, 20, 1e-6});
  const StepReport report = stepper.step(recorder);
  REQUIRE(recorder.reports.size() >= 3);
  REQUIRE(recorder.reports.size() < 20);
  CHECK(report.outcome == SolveOutcome::converged);
  CHECK(report.newton_iterations == static_cast<int>(recorder.reports.size()) - 1);
  for (std::size_t i = 0; i + 1 < recorder.reports.size(); ++i) {
    CHECK(recorder.reports[i].outcome == SolveOutcome::converged);
    CHECK(recorder.reports[i].newton_residual >= 1e-6);
  }
  CHECK(recorder.reports.back().outcome == SolveOutcome::not_run);
  CHECK(recorder.reports.back().newton_residual < 1e-6);
}

TEST_CASE("Newton ends at its limit") {
  Scene scene = test::moving_scene(10);
  DirectSolve direct(scene);
  LinearProjection projection(scene, direct);
  test::Recorder recorder(projection);
  TimeStepper stepper(scene, {0.02, 2, 0});
  for (int step = 0; step < 3; ++step) CHECK(stepper.step(recorder).newton_iterations == 2);
  REQUIRE(recorder.positions.size() == 6);
  for (int i = 0; i < 6; ++i) {
    CHECK(recorder.positions[i].step == i / 2);
    CHECK(recorder.positions[i].newton == i % 2);
    CHECK(recorder.positions[i].rod == 0);
  }
}

TEST_CASE("a scene at rest needs no solve") {
  BendingRod spec = test::bending_rod(5);
  spec.gravity_m_s2.setZero();
  Simulation simulation(build_scene(spec), StepSettings{});
  CHECK(simulation.step().newton_iterations == 0);
  CHECK(kinetic_energy(simulation.rod()) < 1e-25);
}

TEST_CASE("a step leaves less than Newton's tolerance, with drag and without") {
  for (const double damping : {0.0, 30.0}) {
    BendingRod spec = test::bending_rod(6);
    spec.damping_per_s = damping;
    Simulation simulation(build_scene(spec), {0.02, 20, 1e-10});
    for (int i = 0; i < 5; ++i) {
      simulation.step();
      CHECK(newton_residual(simulation.rod(), simulation.constraint_dt()) < 1e-10);
    }
    if (damping > 0) CHECK(newton_residual(simulation.rod(), 0.02) > 1e-4);
  }
}

TEST_CASE("a failed solve ends the step and is reported") {
  for (const SolveOutcome failure : {SolveOutcome::diverged, SolveOutcome::indefinite, SolveOutcome::not_a_number}) {
    INFO(to_string(failure));
    Scene scene = test::moving_scene(6);
    const double time = scene.time_s;
    DirectSolve direct(scene);
    int calls = 0;
    auto solve = failing(direct, {1, 2, 0}, failure, calls);
    LinearProjection projection(scene, solve);
    TimeStepper stepper(scene, {0.02, 6, 0});
    CHECK(stepper.step(projection).outcome == SolveOutcome::converged);
    calls = 0;
    const StepReport report = stepper.step(projection);
    CHECK(report.outcome == failure);
    CHECK(report.newton_iterations == 3);
    CHECK(calls == 3);
    CHECK(stepper.steps_taken() == 1);
    CHECK(scene.time_s == time + 0.02);
  }
}

TEST_CASE("a solve that hits its iteration limit is applied and reported, and the step goes on") {
  Scene scene = test::moving_scene(6);
  Simulation expected(scene, {0.02, 6, 0});
  DirectSolve direct(scene);
  int calls = 0;
  auto solve = failing(direct, {0, 1, 0}, SolveOutcome::iteration_limit, calls);
  LinearProjection projection(scene, solve);
  TimeStepper stepper(scene, {0.02, 6, 0});
  CHECK(stepper.step(projection).outcome == SolveOutcome::iteration_limit);
  CHECK(stepper.steps_taken() == 1);
  CHECK(stepper.step(projection).outcome == SolveOutcome::converged);
  expected.run(2);
  CHECK(scene.rods[0].position == expected.rod().position);
}

TEST_CASE("a NaN in the state is reported by the step") {
  Scene scene = test::moving_scene(6);
  scene.rods[0].velocity[3].y() = std::numeric_limits<double>::quiet_NaN();
  const SolveOutcome outcome = Simulation(scene, {0.02, 6, 1e-9}).try_step().outcome;
  INFO(to_string(outcome));
  CHECK((outcome == SolveOutcome::not_a_number || outcome == SolveOutcome::indefinite));
}

TEST_CASE("rods of one scene move as each would alone") {
  BendingRod first = test::bending_rod(6), second = test::bending_rod(9, Clamp::wall);
  second.initial_angle_deg = 70;
  Scene both = build_scene(first);
  both.rods.push_back(build_scene(second).rods.front());
  Simulation together(both, {0.02, 6, 0});
  together.run(10);
  for (const int r : {0, 1}) {
    Simulation alone(build_scene(r == 0 ? first : second), {0.02, 6, 0});
    alone.run(10);
    CHECK(together.scene.rods[r].position == alone.rod().position);
    CHECK(together.scene.rods[r].velocity == alone.rod().velocity);
  }
}

TEST_CASE("outcomes of solves keep the numbers and names that files hold") {
  const char* const solves[] = {"not_run",  "converged",  "zero_rhs",    "iteration_limit",
                                "diverged", "indefinite", "not_a_number"};
  for (int i = 0; i < 7; ++i) CHECK(to_string(static_cast<SolveOutcome>(i)) == std::string(solves[i]));
}

TEST_CASE("loads and clamps on segments that do not exist, and clamps on free ones, are refused") {
  const Scene good = build_scene(test::bending_rod(4));
  const auto still = [](double) { return Pose{Vector3::Zero(), Quaternion::Identity()}; };
  const auto refused = [](const Scene& with, const char* what) {
    Scene scene = with;
    CHECK_THROWS_MATCHES(TimeStepper(scene, {}), SceneError, Catch::Matchers::Message(what));
  };
  Scene load = good, other_rod = good, clamp = good, free = good;
  load.loads.push_back({0, 4, {}, {}, {}});
  refused(load, "a point load refers to segment 4 of rod 0, which the scene does not have");
  other_rod.loads.push_back({1, 0, {}, {}, {}});
  refused(other_rod, "a point load refers to segment 0 of rod 1, which the scene does not have");
  clamp.clamps.push_back({0, -1, still});
  refused(clamp, "a moving clamp refers to segment -1 of rod 0, which the scene does not have");
  free.clamps.push_back({0, 2, still});
  refused(free, "a moving clamp needs a static segment; segment 2 is free");
}

}  // namespace rodsweep::test_stepping
