// Obstacles in jobs: scenes made from them, sweeps over them, refusals before the run.
#include <catch2/catch.hpp>
#include <string>

#include "tests/runner/job_examples.hpp"

namespace rodsweep {
namespace test_job_obstacles {

/// The small job with contact and with these obstacles.
Json job_with(const std::string& obstacles) {
  return with("/scene/obstacles", obstacles, with("/scene/contact", R"({"friction": 0.3})"));
}

Scene scene_of(const Plan& plan, std::int64_t task = 0) { return build_scene(plan.spec(task).scene); }

std::vector<std::string> texts(const Plan& plan, const std::string& path) {
  for (const ParameterColumn& column : plan.parameters())
    if (column.path == path) return std::get<ColumnValues<std::string>>(column.values).all();
  return {};
}

TEST_CASE("obstacles of every kind stand in the scene, beside its own floor") {
  CHECK(scene_of(plan_of(small_job())).obstacles.empty());
  const std::string three =
      R"([{"half_space": {"point_m": [0, -3, 0], "normal": [1, 2, 0], "velocity_m_s": [0, 1, 0]}},
          {"ball": {"centre_m": [0, -1, 0], "radius_m": 0.2, "velocity_m_s": [0, 0, -2]}},
          {"capsule": {"from_m": [0, 0, 1], "to_m": [1, 0, 1], "radius_m": 0.1, "velocity_m_s": [3, 0, 0]}}])";
  const Scene rod = scene_of(plan_of(job_with(three)));
  REQUIRE(rod.obstacles.size() == 3);
  CHECK(std::get<HalfSpace>(rod.obstacles[0]).point_m == Vector3(0, -3, 0));
  CHECK(std::get<HalfSpace>(rod.obstacles[0]).normal == Vector3(1, 2, 0));
  CHECK(std::get<Ball>(rod.obstacles[1]).centre_m == Vector3(0, -1, 0));
  CHECK(std::get<Ball>(rod.obstacles[1]).radius_m == 0.2);
  CHECK(std::get<Capsule>(rod.obstacles[2]).from_m == Vector3(0, 0, 1));
  CHECK(std::get<Capsule>(rod.obstacles[2]).to_m == Vector3(1, 0, 1));
  CHECK(std::get<Capsule>(rod.obstacles[2]).radius_m == 0.1);

  CHECK(std::get<HalfSpace>(rod.obstacles[0]).velocity_m_s == Vector3(0, 1, 0));
  CHECK(std::get<Ball>(rod.obstacles[1]).velocity_m_s == Vector3(0, 0, -2));
  CHECK(std::get<Capsule>(rod.obstacles[2]).velocity_m_s == Vector3(3, 0, 0));

  Json falling = with("/scene/type", "\"falling_rods\"", job_with(R"([{"half_space": {}}])"));
  falling["scene"]["rods"] = 2;
  falling["scene"]["height_m"] = 0.3;
  const Scene heap = scene_of(plan_of(falling));
  REQUIRE(heap.obstacles.size() == 2);
  CHECK(std::get<HalfSpace>(heap.obstacles[0]).normal == Vector3(0, 1, 0));
  for (const Obstacle& still : heap.obstacles) CHECK(std::get<HalfSpace>(still).velocity_m_s.isZero(0));
}

TEST_CASE("values of obstacles, whole ones and whole lists of them are swept") {
  Json drawn = job_with(R"([{"ball": {"centre_m": [0, {"uniform": [-2, -1]}, 0], "radius_m": {"grid": [0.1, 0.2]}}}])");
  drawn["samples"] = 3;
  const Plan balls = plan_of(drawn);
  REQUIRE(balls.size() == 6);
  const Ball ball = std::get<Ball>(scene_of(balls, 4).obstacles.at(0));
  CHECK(ball.radius_m == 0.2);
  CHECK(ball.centre_m.y() < -1);
  CHECK(ball.centre_m.y() == std::get<Ball>(scene_of(balls, 1).obstacles.at(0)).centre_m.y());
  CHECK(texts(balls, "scene.obstacles").empty());

  const std::string bar = R"({"capsule": {"from_m": [1, -1, -1], "to_m": [1, -1, 1], "radius_m": 0.1}})";
  const Plan lists = plan_of(job_with(R"({"grid": [[], [{"half_space": {}}], [{"half_space": {}}, )" + bar + "]]}"));
  CHECK(scene_of(lists, 0).obstacles.empty());
  CHECK(scene_of(lists, 2).obstacles.size() == 2);
  CHECK(texts(lists, "scene.obstacles") == std::vector<std::string>{"none", "half_space", "half_space, capsule"});

  const Plan kinds = plan_of(job_with(R"([{"grid": [{"half_space": {}}, )" + bar + "]}]"));
  CHECK(std::holds_alternative<HalfSpace>(scene_of(kinds, 0).obstacles.at(0)));
  CHECK(std::holds_alternative<Capsule>(scene_of(kinds, 1).obstacles.at(0)));
  CHECK(texts(kinds, "scene.obstacles[0]") == std::vector<std::string>{"half_space", "capsule"});
}

}  // namespace test_job_obstacles
}  // namespace rodsweep
