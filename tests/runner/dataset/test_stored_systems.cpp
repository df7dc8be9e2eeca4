// Systems in a record: A and b, assembled again after reading, equal those of the solve.
#include <catch2/catch.hpp>
#include <cmath>

#include "runner/dataset/stored_systems.hpp"
#include "tests/runner/data_set_examples.hpp"
#include "tests/runner/stored_examples.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep {
namespace test_stored_systems {

TaskRecord evaluated(const Plan& plan) {
  TaskRecord record = record_of(plan);
  REQUIRE(record.outcome == TaskOutcome::ok);
  return record;
}

TEST_CASE("A, b, velocities and solution of a tree and a chain of another size come back to the last bit") {
  constexpr int steps = 3, iterations = 2;
  const bool balance = GENERATE(false, true);
  Scene scene;
  scene.damping_per_s = 2;  // so that the constraints' dt differs from the step
  scene.rods = {test::random_rod(test::tree(2, 2), {0}, 1), test::random_rod(test::chain(4), {}, 2)};
  if (balance)
    for (Rod& rod : scene.rods)
      for (const Segment& segment : rod.segments) rod.contact_impulse.push_back(1e-3 * segment.mass * Vector6::Ones());
  const Scene start = scene;
  Task task;
  task.rows[Rows::system].count = steps * iterations * 2;
  task.rows[Rows::system_segment].count = steps * iterations * (7 + 4);
  task.rows[Rows::system_joint].count = steps * iterations * (6 + 3);
  if (balance) task.rows[Rows::balanced_segment].count = task.rows[Rows::system_segment].count;
  TaskRecord record;
  record.prepare(task, {});

  SolveProbe probe(scene);
  StoringSolve recording(scene, iterations, probe, record);
  LinearProjection projection(scene, recording, balance ? std::optional(1e-12) : std::nullopt);
  TimeStepper stepper(scene, {0.01, iterations + 1, 0});
  for (int step = 0; step < steps; ++step) stepper.step(projection);

  const std::vector<StoredSystem> systems = stored_systems(record, start, iterations);
  CHECK(systems.size() == steps * iterations * 2);
  for (const StoredSystem& system : systems) CHECK(system.balance.has_value() == balance);
  check_same(systems, start, probe.first_iterations(iterations));
}

TEST_CASE("a data set's record has the first system of every step, or all") {
  Json job = data_job();
  job["time"]["newton_tolerance"] = 0;  // so that all iterations are needed
  const TaskRecord first = evaluated(plan_of(job));
  CHECK(first.systems.step == std::vector<std::int32_t>{0, 1, 2, 3});
  CHECK(first.systems.newton == std::vector<std::int16_t>{0, 0, 0, 0});
  CHECK(first.systems.rod == std::vector<std::int16_t>{0, 0, 0, 0});
  CHECK(first.systems.velocity_m_s.front() == 0);  // at the start of the first step
  job["record"] = {{"systems", "all"}};
  const TaskRecord all = evaluated(plan_of(job));
  REQUIRE(all.systems.step.size() == 4 * 3);
  CHECK(all.systems.step[5] == 1);
  CHECK(all.systems.newton[5] == 2);
  const std::size_t segments = 10;
  for (std::size_t step = 0; step < 4; ++step)
    for (std::size_t i = 0; i < 3 * segments; ++i)
      CHECK(first.systems.position_m[3 * segments * step + i] == all.systems.position_m[9 * segments * step + i]);
}

TEST_CASE("Newton iterations that were not needed stay marked and are not read") {
  Json job = data_job();
  job["scene"]["gravity_m_s2"] = {0, 0, 0};  // the first residual is zero
  job["record"] = {{"systems", "all"}};
  const Plan plan = plan_of(job);
  const TaskRecord record = evaluated(plan);
  CHECK(record.systems.step == std::vector<std::int32_t>(4 * 3, -1));
  CHECK(std::isnan(record.systems.position_m.back()));
  CHECK(std::isnan(record.systems.solution.front()));
  CHECK(stored_systems(record, build_scene(plan.spec(0).scene), 3).empty());
}

}  // namespace test_stored_systems
}  // namespace rodsweep
