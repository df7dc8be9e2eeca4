// Recorded forces of joints, clamps and obstacles, and what a job without them writes.
#include <cmath>

#include "runner/file/columns.hpp"
#include "tests/catch.hpp"
#include "tests/runner/data_set_examples.hpp"

namespace rodsweep {
namespace test_force_records {

constexpr std::size_t frames = 3;

/// Recorded frames are those of steps 0, 2 and 4.
Json recorded(Json job) {
  job["record"] = {{"trajectory_every", 2}, {"forces", true}};
  return job;
}

/// A rod of ten segments that hangs from a wall.
Json hanging_rod() {
  Json job = recorded(five_steps(R"(["zero"])"));
  job["scene"].update({{"clamp", "wall"}, {"segments", 10}, {"initial_angle_deg", 0}, {"gravity_m_s2", {9.81, 0, 0}}});
  return job;
}

TEST_CASE("a hanging rod's record has the weight below each joint, after each step, and the wall's force") {
  const Json scene = hanging_rod()["scene"];
  const double length = scene["length_m"], radius = scene["radius_m"], density = scene["density_kg_m3"];
  const double weight = density * 3.14159265358979324 * radius * radius * length * 9.81;
  const TaskRecord r = record_of(hanging_rod());
  REQUIRE(r.trajectories.joint_force_n.size() == 3 * frames * 10);
  for (std::size_t frame = 0; frame < frames; ++frame)
    for (std::size_t joint = 0; joint < 10; ++joint) {
      const std::size_t row = 10 * frame + joint;
      const double s = static_cast<double>(joint) / 10;
      CHECK(r.trajectories.joint_position_m(row, 0) == Approx(s * length).margin(1e-5));
      if (frame == 0) {
        CHECK(std::isnan(r.trajectories.joint_force_n(row, 0)));
        CHECK(std::isnan(r.trajectories.joint_moment_nm(row, 2)));
        continue;
      }
      CHECK(r.trajectories.joint_force_n(row, 0) == Approx((1 - s) * weight).epsilon(1e-4));
      CHECK(std::abs(r.trajectories.joint_force_n(row, 1)) < 1e-9 * weight);
      CHECK(std::abs(r.trajectories.joint_moment_nm(row, 2)) < 1e-9 * weight);
    }
  for (std::size_t step = 0; step < 5; ++step) {
    CHECK(r.steps.clamp_force_n(step, 0) == Approx(-weight).epsilon(1e-4));
    CHECK(std::abs(r.steps.clamp_moment_nm(step, 1)) < 1e-9 * weight);
    CHECK(r.steps.obstacle_force_n(step, 0) == 0);
  }
}

TEST_CASE("joints are told by their segments within the frame, rod after rod") {
  Json job = recorded(five_steps(R"(["zero"])"));
  job["scene"] = forest_scene();
  const TaskRecord r = record_of(job);
  const auto &first = r.trajectories.joints.first, &second = r.trajectories.joints.second;
  REQUIRE(first.size() > 4);
  for (std::size_t k = 0; k < first.size(); ++k) {
    CHECK(first[k] < second[k]);
    const auto a = static_cast<std::size_t>(first[k]), b = static_cast<std::size_t>(second[k]);
    CHECK(r.trajectories.segments.rod[a] == r.trajectories.segments.rod[b]);
    for (const std::size_t segment : {a, b}) {  // the joint is at an end of both
      double squared = 0;
      for (std::size_t i = 0; i < 3; ++i)
        squared += std::pow(r.trajectories.joint_position_m(k, i) - r.trajectories.position_m(segment, i), 2);
      CHECK(std::sqrt(squared) == Approx(r.trajectories.segments.length_m[segment] / 2).margin(1e-9));
    }
  }
}

TEST_CASE("a job without forces has none of their columns, and records the same as one with them") {
  Json job = hanging_rod();
  TaskRecord with_forces = record_of(job);
  job["record"].erase("forces");
  const Plan plan = plan_of(job);
  TaskRecord without_forces = record_of(job);
  for (const Column& column : columns()) {
    INFO(column.path);
    if (is_timing(column)) continue;
    if (plan.rows(column.rows) == 0)
      CHECK(bytes_of(column, without_forces).empty());
    else
      CHECK(bytes_of(column, without_forces) == bytes_of(column, with_forces));
  }
  CHECK(without_forces.trajectories.joint_force_n.empty());
  CHECK(without_forces.steps.clamp_force_n.empty());
  CHECK(without_forces.trajectories.joints.first.empty());
}

TEST_CASE("a job without frames records the forces of clamps and obstacles alone") {
  Json job = hanging_rod();
  job["record"] = {{"forces", true}};
  const TaskRecord r = record_of(job);
  CHECK(r.trajectories.joint_force_n.empty());
  CHECK(r.steps.clamp_force_n(4, 0) < 0);
}

TEST_CASE("methods without multipliers have no forces to record") {
  Json job = without("/guesses", recorded(small_job()));
  job["evaluation"] = "closed_loop";
  job["solve"] = {{"method", "xpbd"}};
  CHECK(refusal(job) == "");
  job["solve"] = {{"method", "pbd"}};
  CHECK(
      refusal(job) ==
      "job.json: record.forces: true is not allowed with solve.method \"pbd\", which has no multipliers; must be used "
      "with another method, such as \"direct\"");
}

}  // namespace test_force_records
}  // namespace rodsweep
