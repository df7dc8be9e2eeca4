// Data-set simulations in a batch: bit for bit as alone, and equal to the time step up to rounding.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "network/encoding/stored_simulation.hpp"
#include "runner/dataset/stored_systems.hpp"
#include "runner/experiment/batched_evaluation.hpp"
#include "runner/experiment/task_body.hpp"
#include "runner/file/columns.hpp"
#include "solver/step/time_step.hpp"
#include "tests/runner/job_examples.hpp"

namespace rodsweep {
namespace test_batched_evaluation {

bool never() { return false; }

/// Eight simulations of random rods of nine segments; all systems are recorded.
Json random_data(bool balance = false, const char* integrator = "euler") {
  Json job = data_job();
  job["time"]["balance"] = balance;
  job["time"]["integrator"] = integrator;
  job["samples"] = 8;
  job["scene"]["segments"] = 9;
  job["scene"]["length_m"] = uniform(1, 5);
  job["scene"]["initial_angle_deg"] = uniform(0, 45);
  job["record"] = {{"systems", "all"}, {"trajectory_every", 2}};
  return job;
}

struct Evaluated {
  explicit Evaluated(const Json& job) : plan(plan_of(job)), records(static_cast<std::size_t>(plan.size())) {
    for (const Task& task : plan.tasks()) record(task.index).prepare(task, axis_sizes(plan));
  }
  TaskRecord& record(std::int64_t task) { return records[static_cast<std::size_t>(task)]; }

  void alone() {
    for (const Task& task : plan.tasks()) evaluate(task, plan.spec(task.index), record(task.index), never);
  }
  bool together(const std::vector<std::int64_t>& tasks, const StopRequested& stop = never) {
    std::vector<TaskRun> runs;
    for (const std::int64_t task : tasks) runs.push_back({plan.task(task), plan.spec(task), &record(task)});
    return evaluate_batch(runs, stop);
  }

  Plan plan;
  std::vector<TaskRecord> records;
};

/// The datasets outside /timing in which two records differ.
std::vector<std::string> differing(const TaskRecord& a, const TaskRecord& b) {
  std::vector<std::string> out;
  for (const Column& column : columns())
    if (!is_timing(column) && bytes_of(column, a) != bytes_of(column, b)) out.push_back(column.path);
  return out;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double out = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    REQUIRE(std::isnan(a[i]) == std::isnan(b[i]));
    if (!std::isnan(a[i])) out = std::max(out, std::abs(a[i] - b[i]));
  }
  return out;
}

TEST_CASE("records are the same to the bit alone and in any batch") {
  const Json job = random_data(GENERATE(false, true));
  Evaluated alone(job), together(job), parts(job);
  alone.alone();
  REQUIRE(together.together({0, 1, 2, 3, 4, 5, 6, 7}));
  REQUIRE(parts.together({6, 1, 3}));
  REQUIRE(parts.together({7, 0, 2, 4, 5}));
  for (std::size_t task = 0; task < 8; ++task) {
    CAPTURE(task);
    CHECK(alone.records[task].outcome == TaskOutcome::ok);
    CHECK(differing(alone.records[task], together.records[task]).empty());
    CHECK(differing(alone.records[task], parts.records[task]).empty());
  }
  CHECK(differing(alone.records[0], alone.records[1]).size() > 10);
}

TEST_CASE("records are those of the time step, to rounding") {
  const Json data = random_data(GENERATE(false, true));
  Evaluated batch(data);
  REQUIRE(batch.together({0, 1, 2, 3, 4, 5, 6, 7}));
  Json sweep = data;  // the same seed and key paths give the same rods
  sweep["kind"] = "sweep";
  sweep["solve"] = {{"method", "direct"}};
  sweep["evaluation"] = "closed_loop";
  sweep["record"].erase("systems");
  Evaluated single(sweep);
  single.alone();
  for (std::size_t task = 0; task < 8; ++task) {
    CAPTURE(task);
    const TaskRecord &a = batch.records[task], &b = single.records[task];
    REQUIRE(b.outcome == TaskOutcome::ok);
    CHECK(a.solves.newton == b.solves.newton);
    CHECK(a.steps.newton_iterations == b.steps.newton_iterations);
    CHECK(largest_difference(a.solves.newton_residual, b.solves.newton_residual) < 1e-10);
    CHECK(largest_difference(a.steps.momentum_residual, b.steps.momentum_residual) < 1e-6);
    CHECK(largest_difference(a.solves.joint_gap, b.solves.joint_gap) < 1e-10);
    CHECK(largest_difference(a.solves.rhs_norm, b.solves.rhs_norm) < 1e-10);
    CHECK(largest_difference(a.trajectories.position_m, b.trajectories.position_m) < 1e-10);
    CHECK(largest_difference(a.trajectories.orientation, b.trajectories.orientation) < 1e-10);
    CHECK(largest_difference(a.steps.length_drift, b.steps.length_drift) < 1e-10);
    CHECK(a.trajectories.time_s == b.trajectories.time_s);
  }
}

TEST_CASE("recorded systems are solved by what is recorded as their solutions") {
  const bool balance = GENERATE(false, true);
  Evaluated batch(random_data(balance, GENERATE("euler", "bdf2")));
  REQUIRE(batch.together({0, 1, 2, 3, 4, 5, 6, 7}));
  for (std::int64_t task = 0; task < 8; ++task) {
    const TaskSpec spec = batch.plan.spec(task);
    Scene scene = build_scene(spec.scene);
    Rod& rod = scene.rods.front();
    const std::vector<StoredSystem> systems = stored_systems(batch.record(task), scene, 3);
    CHECK(systems.size() >= 8);  // four steps of at least two Newton iterations
    for (const StoredSystem& recorded : systems) {
      LinearSystem system(rod);
      assemble_again(recorded, rod, system);
      CHECK(system.keeps_balance() == balance);
      VectorX product = VectorX::Zero(system.rhs().size());
      system.matrix().multiply(recorded.solution.data(), product.data());
      CHECK((product - system.rhs()).norm() <= 1e-10 * system.rhs().norm() + 1e-14);
    }
  }
}

TEST_CASE("a member that fails ends alone, with its reason") {
  Json job = random_data();
  job["samples"] = 1;
  job["scene"]["gravity_m_s2"] = grid({{0, -9.81, 0}, {0, -1e6, 0}, {0, -1, 0}});  // the second tears the rod
  Evaluated alone(job), together(job);
  alone.alone();
  REQUIRE(together.together({0, 1, 2}));
  CHECK(together.records[0].outcome == TaskOutcome::ok);
  CHECK(together.records[1].outcome == TaskOutcome::diverged);
  CHECK(together.records[1].tasks.steps_done[0] < 4);
  CHECK(together.records[1].message.find("joint lengths") != std::string::npos);
  CHECK(together.records[2].outcome == TaskOutcome::ok);
  CHECK(together.records[2].tasks.steps_done[0] == 4);
  for (std::size_t task = 0; task < 3; ++task) CHECK(differing(alone.records[task], together.records[task]).empty());
}

TEST_CASE("rods that do not fit together are an error of each task, not the end of the worker") {
  Json job = random_data();
  job["samples"] = 1;
  job["scene"]["segments"] = grid({9, 10});
  Evaluated unequal(job);
  REQUIRE(unequal.together({0, 1}));
  for (std::size_t task = 0; task < 2; ++task) {
    CHECK(unequal.records[task].outcome == TaskOutcome::error);
    CHECK(unequal.records[task].message == "scene 1 of a batch has 10 segments; the first one has 9");
  }
}

TEST_CASE("a time limit ends every member, a request all of them") {
  Json job = random_data();
  job["task_time_limit_s"] = 1e-9;
  Evaluated limited(job);
  REQUIRE(limited.together({0, 1}));
  for (std::size_t task = 0; task < 2; ++task) {
    CHECK(limited.records[task].outcome == TaskOutcome::timed_out);
    CHECK(limited.records[task].tasks.steps_done[0] == 0);
  }
  Evaluated stopped(random_data());
  int asked = 0;
  CHECK_FALSE(stopped.together({0, 1}, [&] { return ++asked > 2; }));
}

TEST_CASE("data sets of chains step in batches of equal ones, other tasks alone") {
  Json job = data_job();
  job["scene"]["segments"] = grid({5, 6});
  job["scene"]["clamp"] = grid({"segment", "wall"});
  job["scene"]["initial_angle_deg"] = grid({0, 10});
  const Plan plan = plan_of(job);
  CHECK(batches(plan) == std::vector<std::int64_t>{0, 0, 1, 1, 2, 2, 3, 3});

  CHECK(batches(plan_of(small_job())) == std::vector<std::int64_t>{-1});
  CHECK(batches(plan_of(with("/scene/tip_force_n", "[0, 1, 0]", data_job()))) == std::vector<std::int64_t>{-1});
  CHECK(batches(plan_of(with("/scene/tip_torque_nm", "[0, 1, 0]", data_job()))) == std::vector<std::int64_t>{-1});
  CHECK(batches(plan_of(with("/scene/tip_motion", R"({"duration_s": 1})", data_job()))) ==
        std::vector<std::int64_t>{-1});
  CHECK(batches(plan_of(with("/scene/wind", R"({"mean_m_s": [5, 0, 0]})", data_job()))) ==
        std::vector<std::int64_t>{-1});
  CHECK(batches(plan_of(with("/scene/stretch", "\"physical\"", data_job()))) == std::vector<std::int64_t>{-1});
  CHECK(batches(plan_of(with("/scene", helix_scene().dump(), data_job()))) == std::vector<std::int64_t>{0});
}

TEST_CASE("an assignment's records are written one by one, those of a request to stop not at all") {
  const Plan plan = plan_of(random_data());
  std::vector<std::int64_t> written;
  BatchBody body = task_body(plan, [&](const Task& task, const TaskRecord& record, const TaskOrigin*) {
    CHECK(record.outcome == TaskOutcome::ok);
    written.push_back(task.index);
  });
  const std::vector<TaskResult> results = body({2, 5, 7}, never);
  REQUIRE(results.size() == 3);
  CHECK(results[1].outcome == TaskOutcome::ok);
  CHECK(written == std::vector<std::int64_t>{2, 5, 7});
  const std::vector<TaskResult> stopped = body({1, 3}, [] { return true; });
  REQUIRE(stopped.size() == 2);
  CHECK(stopped[0].outcome == TaskOutcome::pending);
  CHECK(written.size() == 3);
}

}  // namespace test_batched_evaluation
}  // namespace rodsweep
