// Scenes in jobs: the structs and segments that their keys become. jobs/schema.json has their defaults; test_job_refusals.cpp
// and inputs/ have what is refused.
#include <string>

#include "runner/measure/plan_check.hpp"
#include "tests/catch.hpp"
#include "tests/runner/job_examples.hpp"

using namespace rodsweep;
using Catch::Matchers::ContainsSubstring;

namespace test_job_scenes {

/// The small job with a scene of these keys and one material.
Json job_with_scene(const std::string& keys) {
  return with("/scene",
              "{" + keys + R"(, "density_kg_m3": 1000, "youngs_modulus_pa": 1e6, "torsion_modulus_pa": 5e5})");
}

Json ring_job() { return job_with_scene(R"("type": "ring", "segments": 12, "length_m": 3, "radius_m": 0.05)"); }

Json net_job() {
  return job_with_scene(R"("type": "net", "rows": 3, "columns": 4, "segments": 2, "mesh_m": 0.5, "radius_m": 0.05)");
}

Json lattice_job() {
  return job_with_scene(R"("type": "lattice", "nodes_x": 3, "segments": 2, "mesh_m": 0.5, "radius_m": 0.05)");
}

Json tree_job(const std::string& type = "tree", const std::string& more = "") {
  return job_with_scene("\"type\": \"" + type + R"(", "depth": 2, "branches": 3, "segments": 2, "length_m": 2,
      "radius_m": 0.1)" +
                        more);
}

/// The small job with contact and with these obstacles.
Json job_with_obstacles(const std::string& obstacles) {
  return with("/scene/obstacles", obstacles, with("/scene/contact", R"({"friction": 0.3})"));
}

template <class Kind = BendingRod>
Kind spec_of(const Plan& plan, std::int64_t task = 0) {
  return std::get<Kind>(plan.spec(task).scene);
}
template <class Kind = BendingRod>
Kind spec_of(const Json& job) {
  return spec_of<Kind>(plan_of(job));
}

Scene scene_of(const Plan& plan, std::int64_t task = 0) { return build_scene(plan.spec(task).scene); }

void check_size(const Plan& plan, int segments, int joints) {
  CHECK(plan.task(0).segments == segments);
  CHECK(plan.task(0).joints == joints);
}

TEST_CASE("a helix's keys become a helix") {
  const auto helix = spec_of<Helix>(with("/scene", helix_scene().dump()));
  CHECK(helix.helix_radius_m == 0.5);
  CHECK(helix.helix_height_m == 0.4);
  CHECK(helix.windings == 2);
  CHECK(helix.segments == 45);
  CHECK_FALSE(helix.stretch_compliance_per_j);
}

TEST_CASE("a ring's keys become a ring") {
  const Plan plan = plan_of(with("/scene/twist_deg", R"({"grid": [0, 720]})", ring_job()));
  check_size(plan, 12, 12);
  CHECK(spec_of<Ring>(plan).length_m == 3);
  CHECK(spec_of<Ring>(plan, 1).twist_deg == 720);
  CHECK(spec_of<Ring>(plan).rest_shape == Ring::RestShape::straight);
  CHECK(spec_of<Ring>(with("/scene/rest_shape", "\"circle\"", ring_job())).rest_shape == Ring::RestShape::circle);
}

TEST_CASE("a net's keys become a net, whose joints the plan counts") {
  const Plan plan = plan_of(net_job());
  check_size(plan, 45, 50);
  CHECK(spec_of<Net>(plan).mesh_m == 0.5);
  CHECK(spec_of<Net>(plan).held == Held::corners);
  CHECK(spec_of<Net>(with("/scene/held", "\"side\"", net_job())).held == Held::side);
}

TEST_CASE("a lattice's keys become a lattice, whose joints the plan counts") {
  const Plan plan = plan_of(lattice_job());
  check_size(plan, 27 * 5, 27 * 4 + 27 * 2 - 8 * 2);  // no joint connects segments held at the corners
  CHECK(spec_of<Lattice>(plan).cell == Lattice::Cell::cubic);
  CHECK(spec_of<Lattice>(plan).mesh_m == 0.5);

  Json job = with("/scene/cell", R"({"grid": ["body_centred", "octet"]})", lattice_job());
  job["scene"].update({{"nodes_y", 2},
                       {"nodes_z", 4},
                       {"held", "side"},
                       {"node_stiffness", 7},
                       {"initial_angle_deg", 20},
                       {"tip_force_n", {0, -2, 1}}});
  const Plan other = plan_of(job);
  CHECK(spec_of<Lattice>(other).cell == Lattice::Cell::body_centred);
  const auto octet = spec_of<Lattice>(other, 1);
  CHECK(octet.cell == Lattice::Cell::octet);
  CHECK(octet.nodes_y == 2);
  CHECK(octet.nodes_z == 4);
  CHECK(octet.held == Held::side);
  CHECK(octet.node_stiffness == 7);
  CHECK(octet.initial_angle_deg == 20);
  CHECK(octet.tip_force_n == Vector3(0, -2, 1));
}

TEST_CASE("a tree's keys become a tree, and a forest has rows of solves and systems for every tree") {
  check_size(plan_of(tree_job()), 27, 26);
  CHECK(spec_of<Tree>(tree_job()).shape.length_m == 2);
  CHECK(spec_of<Tree>(tree_job()).shape.phyllotaxis == TreeShape::Phyllotaxis::golden);
  const auto random =
      spec_of<Tree>(tree_job("tree", R"(, "phyllotaxis": "random", "tree_seed": 9, "modulus_exponent": 0.5)"));
  CHECK(random.shape.phyllotaxis == TreeShape::Phyllotaxis::random);
  CHECK(random.shape.seed == 9);
  CHECK(random.modulus_exponent == 0.5);

  const Json forest = tree_job("forest", R"(, "rows": 2, "columns": 3, "spacing_m": 4)");
  check_size(plan_of(forest), 6 * 27, 6 * 26);
  CHECK(plan_of(forest).task(0).rows[Rows::solve].count == 10 * 20 * 6);
  const Task data = plan_of(with("/scene", forest["scene"].dump(), data_job())).task(0);
  CHECK(data.rows[Rows::system].count == 4 * 6);
  CHECK(data.rows[Rows::system_segment].count == 4 * 6 * 27);
  CHECK(data.rows[Rows::system_joint].count == 4 * 6 * 26);
}

TEST_CASE("the scenes that are made for contact are read from their keys, and count all their rods") {
  const auto plan = [](const std::string& keys) { return plan_of(job_with_scene(keys + R"(, "radius_m": 0.01)")); };
  const Plan falling =
      plan(R"("type": "falling_rods", "rods": 3, "segments": 5, "length_m": 1, "height_m": 0.3, "turn_deg": 70)");
  check_size(falling, 15, 12);
  CHECK(falling.task(0).rows[Rows::solve].count % (3 * falling.task(0).steps) == 0);
  const auto rods = spec_of<FallingRods>(falling);
  CHECK(rods.height_m == 0.3);
  CHECK(rods.contact.has_value());
  CHECK(rods.turn_deg == 70);
  CHECK(rods.radius_m == 0.01);
  const Plan coiling = plan(R"("type": "coiling_rod", "segments": 9, "length_m": 1, "height_m": 0.3, "feed_m_s": 2)");
  CHECK(spec_of<CoilingRod>(coiling).feed_m_s == 2);
  const Plan knot = plan(R"("type": "knot", "segments": 40, "length_m": 1, "pull_m_s": 0.3)");
  CHECK(spec_of<Knot>(knot).pull_m_s == 0.3);
  const Plan rings = plan(R"("type": "ring_chain", "rings": 4, "segments": 10, "length_m": 1)");
  check_size(rings, 40, 40);
  const Plan bundle = plan(R"("type": "bundle", "rods": 7, "segments": 4, "length_m": 1, "initial_angle_deg": 30)");
  CHECK(spec_of<Bundle>(bundle).initial_angle_deg == 30);
  CHECK(bundle.task(0).segments == 28);
}

TEST_CASE("rods stretch physically where the job says so; a lattice does unless it says otherwise") {
  const Plan plan = plan_of(with("/scene/stretch", R"({"grid": ["inextensible", "physical"]})"));
  CHECK(spec_of(plan, 0).stretch == Stretch::inextensible);
  CHECK(spec_of(plan, 1).stretch == Stretch::physical);
  CHECK(spec_of<Net>(net_job()).stretch == Stretch::inextensible);
  CHECK(spec_of<Lattice>(lattice_job()).stretch == Stretch::physical);
  CHECK(spec_of<Lattice>(with("/scene/stretch", "\"inextensible\"", lattice_job())).stretch == Stretch::inextensible);
}

TEST_CASE("sections are read with their shape, and swept") {
  const Plan plan = plan_of(with("/scene/section", R"({"grid": ["circle", {"type": "tube", "wall_m": 0.01},
    {"type": "rectangle", "width_m": 0.1, "height_m": {"grid": [0.01, 0.02]}},
    {"type": "numbers", "area_m2": 1, "second_moment_height_m4": 2, "second_moment_width_m4": 3,
     "torsion_constant_m4": 4}]})"));
  REQUIRE(plan.size() == 5);
  const auto section = [&](int task) { return *spec_of(plan, task).section; };
  CHECK_FALSE(spec_of(plan).section);
  CHECK(std::get<Tube>(section(1)).wall_m == 0.01);
  CHECK(std::get<Rectangle>(section(2)).width_m == 0.1);
  CHECK(std::get<Rectangle>(section(3)).height_m == 0.02);
  const auto given = std::get<GivenSection>(section(4));
  CHECK(given.second_moment_height_m4 == 2);
  CHECK(given.second_moment_width_m4 == 3);
  CHECK(given.torsion_constant_m4 == 4);
  CHECK(spec_of<Ring>(with("/scene/section", R"({"type": "tube", "wall_m": 0.01})", ring_job())).section);
}

TEST_CASE("tips are loaded, or moved") {
  const auto moved = spec_of(with("/scene/tip_motion", R"({"duration_s": 2, "displacement_m": [-0.3, 0, 0]})"));
  REQUIRE(moved.tip_motion);
  CHECK(moved.tip_motion->displacement_m == Vector3(-0.3, 0, 0));
  CHECK(moved.tip_motion->rotation_deg == Vector3(0, 0, 0));
  CHECK(moved.tip_motion->duration_s == 2);
  const auto loaded = spec_of(with("/scene/tip_torque_nm", "[1, 2, 3]"));
  CHECK(loaded.tip_torque_nm == Vector3(1, 2, 3));
  CHECK_FALSE(loaded.tip_motion);
}

TEST_CASE("wind and contact are parts of any scene, also as one value of a grid with none") {
  const Plan windy = plan_of(
      with("/scene/wind", R"({"grid": ["none", {"mean_m_s": [{"grid": [3, 5]}, 0, 1], "gust_strength": 0.3}]})"));
  REQUIRE(windy.size() == 3);
  CHECK_FALSE(scene_of(windy).wind);
  CHECK(scene_of(windy, 1).wind);
  const auto wind = *spec_of(windy, 2).wind;
  CHECK(wind.mean_m_s == Vector3(5, 0, 1));
  CHECK(wind.gust_strength == 0.3);

  const Plan plan = plan_of(with("/scene/contact", R"({"grid": ["none", {"friction": 0.6, "sweeps": 9}]})", net_job()));
  CHECK_FALSE(spec_of<Net>(plan).contact);
  const auto contact = *spec_of<Net>(plan, 1).contact;
  CHECK(contact.friction == 0.6);
  CHECK(contact.sweeps == 9);
}

TEST_CASE("loads, motions and changes of gravity are read, and their values may be sweeps") {
  const Plan plan = plan_of(with("/scene/loads", R"([
      {"at_m": [1, 0, 0], "force_n": [0, {"grid": [-1, -2]}, 0], "times_s": [0, 1], "factors": [0, 3], "smooth": true},
      {"at_m": [0.5, 0, 0], "torque_nm": [1, 0, 0]}])"));
  REQUIRE(plan.size() == 2);
  const Prescribed read = spec_of(plan, 1).prescribed;
  REQUIRE(read.loads.size() == 2);
  CHECK(read.loads[0].force_n == Vector3(0, -2, 0));
  CHECK(read.loads[0].schedule.at(2) == 3);
  CHECK(read.loads[0].schedule.smooth);
  CHECK(read.loads[1].torque_nm == Vector3(1, 0, 0));
  CHECK(read.loads[1].schedule.at(2) == 1);
  const Prescribed other =
      spec_of(with("/scene/motions", R"([{"at_m": [0, 0, 0], "rotation_deg": [90, 0, 0], "times_s": [0, 1],
      "factors": [0, 1]}])",
                   with("/scene/gravity_changes", R"([{"by_m_s2": [0, 9.81, 0]}])")))
          .prescribed;
  CHECK(other.motions.at(0).rotation_deg == Vector3(90, 0, 0));
  CHECK(other.gravity.at(0).by_m_s2 == Vector3(0, 9.81, 0));
}

TEST_CASE("obstacles of every kind stand in the scene, beside its own floor") {
  CHECK(scene_of(plan_of(small_job())).obstacles.empty());
  const Scene rod = scene_of(plan_of(job_with_obstacles(
      R"([{"half_space": {"point_m": [0, -3, 0], "normal": [1, 2, 0], "velocity_m_s": [0, 1, 0]}},
          {"ball": {"centre_m": [0, -1, 0], "radius_m": 0.2, "velocity_m_s": [0, 0, -2]}},
          {"capsule": {"from_m": [0, 0, 1], "to_m": [1, 0, 1], "radius_m": 0.1, "velocity_m_s": [3, 0, 0]}}])")));
  REQUIRE(rod.obstacles.size() == 3);
  const auto floor = std::get<HalfSpace>(rod.obstacles[0]);
  CHECK(floor.point_m == Vector3(0, -3, 0));
  CHECK(floor.normal == Vector3(1, 2, 0));
  CHECK(floor.velocity_m_s == Vector3(0, 1, 0));
  const auto ball = std::get<Ball>(rod.obstacles[1]);
  CHECK(ball.centre_m == Vector3(0, -1, 0));
  CHECK(ball.radius_m == 0.2);
  CHECK(ball.velocity_m_s == Vector3(0, 0, -2));
  const auto capsule = std::get<Capsule>(rod.obstacles[2]);
  CHECK(capsule.from_m == Vector3(0, 0, 1));
  CHECK(capsule.to_m == Vector3(1, 0, 1));
  CHECK(capsule.radius_m == 0.1);
  CHECK(capsule.velocity_m_s == Vector3(3, 0, 0));

  Json falling = with("/scene/type", "\"falling_rods\"", job_with_obstacles(R"([{"half_space": {}}])"));
  falling["scene"].update({{"rods", 2}, {"height_m", 0.3}});
  const Scene heap = scene_of(plan_of(falling));
  REQUIRE(heap.obstacles.size() == 2);
  CHECK(std::get<HalfSpace>(heap.obstacles[0]).normal == Vector3(0, 1, 0));
  for (const Obstacle& still : heap.obstacles) CHECK(std::get<HalfSpace>(still).velocity_m_s.isZero(0));
}

TEST_CASE("values of obstacles, whole ones and whole lists of them are swept") {
  const auto names = [](const Plan& plan, const char* path) { return values_of<std::string>(plan, path); };
  Json drawn = job_with_obstacles(
      R"([{"ball": {"centre_m": [0, {"uniform": [-2, -1]}, 0], "radius_m": {"grid": [0.1, 0.2]}}}])");
  drawn["samples"] = 3;
  const Plan balls = plan_of(drawn);
  REQUIRE(balls.size() == 6);
  const Ball ball = std::get<Ball>(scene_of(balls, 4).obstacles.at(0));
  CHECK(ball.radius_m == 0.2);
  CHECK(ball.centre_m.y() < -1);
  CHECK(ball.centre_m.y() == std::get<Ball>(scene_of(balls, 1).obstacles.at(0)).centre_m.y());
  CHECK_FALSE(find_column(balls, "scene.obstacles"));

  const std::string bar = R"({"capsule": {"from_m": [1, -1, -1], "to_m": [1, -1, 1], "radius_m": 0.1}})";
  const Plan lists =
      plan_of(job_with_obstacles(R"({"grid": [[], [{"half_space": {}}], [{"half_space": {}}, )" + bar + "]]}"));
  CHECK(scene_of(lists, 0).obstacles.empty());
  CHECK(scene_of(lists, 2).obstacles.size() == 2);
  CHECK(names(lists, "scene.obstacles") == std::vector<std::string>{"none", "half_space", "half_space, capsule"});

  const Plan kinds = plan_of(job_with_obstacles(R"([{"grid": [{"half_space": {}}, )" + bar + "]}]"));
  CHECK(std::holds_alternative<HalfSpace>(scene_of(kinds, 0).obstacles.at(0)));
  CHECK(std::holds_alternative<Capsule>(scene_of(kinds, 1).obstacles.at(0)));
  CHECK(names(kinds, "scene.obstacles[0]") == std::vector<std::string>{"half_space", "capsule"});
}

TEST_CASE("guesses that need single chains are refused for other scenes before anything runs") {
  const auto refused = [](Json job, const char* guess) {
    job["guesses"].push_back(Json::parse(guess));
    return message_of<JobError>([&] { check_guesses(plan_of(job)); });
  };
  const char* knn = R"({"knn": {"data": ")" PRETRAINED R"(/rods.h5"}})";  // the file is not read yet
  CHECK(refused(small_job(), knn).empty());
  CHECK_THAT(refused(ring_job(), knn), ContainsSubstring("guesses[2]: \"knn\" ") &&
                                           ContainsSubstring("rods with loops") &&
                                           ContainsSubstring("12 segments of task 0"));
  CHECK_THAT(refused(tree_job(), knn),
             ContainsSubstring("rods with branches") && ContainsSubstring("27 segments of task 0"));
  CHECK(refused(with("/scene/depth", "0", tree_job()), knn).empty());
  CHECK(refused(net_job(), R"({"copingnet": {"model": ")" PRETRAINED R"(/bending-paper.h5"}})").empty());
  CHECK_THAT(
      refused(small_job(), R"({"copingnet": {"model": ")" PRETRAINED R"(/bending-paper.h5", "corrections": 2}})"),
      ContainsSubstring("guesses[2]: corrections above 1 ") &&
          ContainsSubstring("bending-paper.h5, a network without factors"));
}

TEST_CASE("a scene whose factor needs too much memory is refused before it runs, with what does without") {
  constexpr double little = 1e6;
  const auto refusal_of_factors = [](const Json& job) {
    return message_of<JobError>([&] { check_factors(plan_of(job), little); });
  };
  Json job = job_with_scene(R"("type": "lattice", "nodes_x": 4, "segments": 2, "mesh_m": 0.2, "radius_m": 0.01)");
  CHECK_THAT(refusal_of_factors(job),
             ContainsSubstring("solve: task 0: a direct solve of 400 joints needs 0.00") &&
                 ContainsSubstring("0.000931 GiB; must be a smaller scene, or method \"cg\" with "
                                   "\"reference\": \"cg\" (no factorisation)"));
  job["solve"]["reference"] = "cg";
  CHECK(refusal_of_factors(job) == "");
  job["guesses"] = Json::parse(R"(["zero", {"guarded": {"guess": {"oracle": {"error": 0.1}}, "threshold": 1}}])");
  CHECK_THAT(refusal_of_factors(job), ContainsSubstring("guesses: task 0: ") && ContainsSubstring("no \"oracle\""));
  job["guesses"] = {"zero"};
  job["scene"]["contact"] = Json::object();
  CHECK_THAT(refusal_of_factors(job),
             ContainsSubstring("scene.contact: task 0: ") && ContainsSubstring("without contact"));
  CHECK_NOTHROW(check_factors(plan_of(job)));
  // The memory of chains and trees grows linearly, so they are not checked.
  CHECK(refusal_of_factors(with("/scene/segments", "100000")) == "");
}

}  // namespace test_job_scenes
