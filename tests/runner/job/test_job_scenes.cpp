// Rings, nets, lattices and physical stretch in jobs: scenes made from them, refusals before the run. jobs/schema.json
// has their defaults.
#include <catch2/catch.hpp>
#include <string>

#include "runner/measure/plan_check.hpp"
#include "tests/runner/job_examples.hpp"

using namespace rodsweep;

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

/// The error message of check_guesses() for a job; "" if there is none.
std::string refusal_of_loops(const Json& job) {
  return message_of<JobError>([&] { check_guesses(plan_of(job)); });
}

Json guess_of_model(Json job) {
  job["guesses"].push_back({{"copingnet", {{"model", RODSWEEP_JOBS "/../network/pretrained/bending-paper.h5"}}}});
  return job;
}

TEST_CASE("a ring's keys become a ring") {
  const Plan plan = plan_of(with("/scene/twist_deg", R"({"grid": [0, 720]})", ring_job()));
  const Ring plain = std::get<Ring>(plan.spec(0).scene), twisted = std::get<Ring>(plan.spec(1).scene);
  CHECK(plain.segments == 12);
  CHECK(plain.length_m == 3);
  CHECK(plain.twist_deg == 0);
  CHECK(twisted.twist_deg == 720);
  CHECK(plain.rest_shape == Ring::RestShape::straight);
  CHECK(std::get<Ring>(plan_of(with("/scene/rest_shape", "\"circle\"", ring_job())).spec(0).scene).rest_shape ==
        Ring::RestShape::circle);
  CHECK(plan.task(0).segments == 12);
  CHECK(plan.task(0).joints == 12);
}

TEST_CASE("a net's keys become a net, whose joints the plan counts") {
  const Plan plan = plan_of(net_job());
  const Net net = std::get<Net>(plan.spec(0).scene);
  CHECK(net.rows == 3);
  CHECK(net.columns == 4);
  CHECK(net.segments == 2);
  CHECK(net.mesh_m == 0.5);
  CHECK(net.held == Held::corners);
  CHECK(plan.task(0).segments == 45);
  CHECK(plan.task(0).joints == 50);
  CHECK(std::get<Net>(plan_of(with("/scene/held", "\"side\"", net_job())).spec(0).scene).held == Held::side);
}

TEST_CASE("a lattice's keys become a lattice, whose joints the plan counts") {
  const Plan plan = plan_of(lattice_job());
  const Lattice plain = std::get<Lattice>(plan.spec(0).scene);
  CHECK(plain.cell == Lattice::Cell::cubic);
  CHECK(plain.nodes_x == 3);
  CHECK(plain.segments == 2);
  CHECK(plain.mesh_m == 0.5);
  CHECK(plan.task(0).segments == 27 * 5);
  CHECK(plan.task(0).joints == 27 * 4 + 27 * 2 - 8 * 2);  // no joint connects segments held at the corners

  Json job = with("/scene/cell", R"({"grid": ["body_centred", "octet"]})", lattice_job());
  job["scene"].update({{"nodes_y", 2},
                       {"nodes_z", 4},
                       {"held", "side"},
                       {"node_stiffness", 7},
                       {"initial_angle_deg", 20},
                       {"tip_force_n", {0, -2, 1}}});
  const Plan other = plan_of(job);
  CHECK(std::get<Lattice>(other.spec(0).scene).cell == Lattice::Cell::body_centred);
  const Lattice octet = std::get<Lattice>(other.spec(1).scene);
  CHECK(octet.cell == Lattice::Cell::octet);
  CHECK(octet.nodes_y == 2);
  CHECK(octet.nodes_z == 4);
  CHECK(octet.held == Held::side);
  CHECK(octet.node_stiffness == 7);
  CHECK(octet.initial_angle_deg == 20);
  CHECK(octet.tip_force_n == Vector3(0, -2, 1));
  CHECK(other.task(1).joints == joint_count(octet));
}

TEST_CASE("a lattice stretches physically unless the job says otherwise, a net the other way round") {
  CHECK(std::get<Lattice>(plan_of(lattice_job()).spec(0).scene).stretch == Stretch::physical);
  CHECK(std::get<Lattice>(plan_of(with("/scene/stretch", "\"inextensible\"", lattice_job())).spec(0).scene).stretch ==
        Stretch::inextensible);
  CHECK(std::get<Net>(plan_of(net_job()).spec(0).scene).stretch == Stretch::inextensible);
}

TEST_CASE("rods stretch physically where the job says so") {
  const Plan plan = plan_of(with("/scene/stretch", R"({"grid": ["inextensible", "physical"]})"));
  CHECK(std::get<BendingRod>(plan.spec(0).scene).stretch == Stretch::inextensible);
  CHECK(std::get<BendingRod>(plan.spec(1).scene).stretch == Stretch::physical);
}

TEST_CASE("sections are read with their shape, and swept") {
  CHECK_FALSE(std::get<BendingRod>(plan_of(small_job()).spec(0).scene).section);
  const Plan plan = plan_of(with("/scene/section", R"({"grid": ["circle", {"type": "tube", "wall_m": 0.01},
    {"type": "rectangle", "width_m": 0.1, "height_m": {"grid": [0.01, 0.02]}},
    {"type": "numbers", "area_m2": 1, "second_moment_height_m4": 2, "second_moment_width_m4": 3,
     "torsion_constant_m4": 4}]})"));
  REQUIRE(plan.size() == 5);
  const auto section = [&](int task) { return *std::get<BendingRod>(plan.spec(task).scene).section; };
  CHECK_FALSE(std::get<BendingRod>(plan.spec(0).scene).section);
  CHECK(std::get<Tube>(section(1)).wall_m == 0.01);
  CHECK(std::get<Rectangle>(section(2)).width_m == 0.1);
  CHECK(std::get<Rectangle>(section(3)).height_m == 0.02);
  const auto given = std::get<GivenSection>(section(4));
  CHECK(given.second_moment_height_m4 == 2);
  CHECK(given.second_moment_width_m4 == 3);
  CHECK(given.torsion_constant_m4 == 4);
  CHECK(std::get<Ring>(plan_of(with("/scene/section", R"({"type": "tube", "wall_m": 0.01})", ring_job())).spec(0).scene)
            .section);
}

TEST_CASE("tips are loaded, or moved") {
  const Json moving = with("/scene/tip_motion", R"({"duration_s": 2, "displacement_m": [-0.3, 0, 0]})");
  const auto moved = std::get<BendingRod>(plan_of(moving).spec(0).scene);
  REQUIRE(moved.tip_motion);
  CHECK(moved.tip_motion->displacement_m == Vector3(-0.3, 0, 0));
  CHECK(moved.tip_motion->rotation_deg == Vector3(0, 0, 0));
  CHECK(moved.tip_motion->duration_s == 2);
  const auto loaded = std::get<BendingRod>(plan_of(with("/scene/tip_torque_nm", "[1, 2, 3]")).spec(0).scene);
  CHECK(loaded.tip_torque_nm == Vector3(1, 2, 3));
  CHECK_FALSE(loaded.tip_motion);
}

TEST_CASE("guesses that need rods without loops are refused before anything runs") {
  const Json knn = {{"knn", {{"data", RODSWEEP_JOBS "/ring.json"}}}};  // the file is not read yet
  Json ring = ring_job(), rod = small_job();
  ring["guesses"].push_back(knn);
  rod["guesses"].push_back(knn);
  CHECK(refusal_of_loops(rod).empty());

  CHECK(refusal_of_loops(guess_of_model(net_job())).empty());
  Json several = guess_of_model(small_job());
  several["guesses"].back()["copingnet"]["corrections"] = 2;
  CHECK_THAT(refusal_of_loops(ring), Catch::Contains("guesses[2]: \"knn\" ") && Catch::Contains("rods with loops") &&
                                         Catch::Contains("12 segments of task 0"));
  CHECK_THAT(refusal_of_loops(several), Catch::Contains("guesses[2]: corrections above 1 ") &&
                                            Catch::Contains("bending-paper.h5, a network without factors"));
}

TEST_CASE("contact is a key of every scene, and none where it is not asked for") {
  CHECK_FALSE(std::get<Net>(plan_of(net_job()).spec(0).scene).contact);
  const Plan plan = plan_of(with("/scene/contact", R"({"grid": ["none", {"friction": 0.6, "sweeps": 9}]})", net_job()));
  REQUIRE(plan.size() == 2);
  CHECK_FALSE(std::get<Net>(plan.spec(0).scene).contact);
  const auto contact = std::get<Net>(plan.spec(1).scene).contact;
  REQUIRE(contact);
  CHECK(contact->friction == 0.6);
  CHECK(contact->sweeps == 9);
  CHECK(contact->tolerance == ContactSettings{}.tolerance);
}

TEST_CASE("the scenes that are made for contact are read from their keys, and count all their rods") {
  const auto plan = [](const std::string& keys) { return plan_of(job_with_scene(keys + R"(, "radius_m": 0.01)")); };
  const Plan falling =
      plan(R"("type": "falling_rods", "rods": 3, "segments": 5, "length_m": 1, "height_m": 0.3, "turn_deg": 70)");
  const FallingRods rods = std::get<FallingRods>(falling.spec(0).scene);
  CHECK(rods.height_m == 0.3);
  CHECK(rods.contact.has_value());
  CHECK(rods.turn_deg == 70);
  CHECK(rods.radius_m == 0.01);
  CHECK(falling.task(0).segments == 15);
  CHECK(falling.task(0).joints == 12);
  CHECK(falling.task(0).rows[Rows::solve].count % (3 * falling.task(0).steps) == 0);
  const Plan coiling = plan(R"("type": "coiling_rod", "segments": 9, "length_m": 1, "height_m": 0.3, "feed_m_s": 2)");
  CHECK(std::get<CoilingRod>(coiling.spec(0).scene).feed_m_s == 2);
  const Plan knot = plan(R"("type": "knot", "segments": 40, "length_m": 1, "pull_m_s": 0.3)");
  CHECK(std::get<Knot>(knot.spec(0).scene).pull_m_s == 0.3);
  const Plan rings = plan(R"("type": "ring_chain", "rings": 4, "segments": 10, "length_m": 1)");
  CHECK(rings.task(0).joints == 40);
  const Plan bundle = plan(R"("type": "bundle", "rods": 7, "segments": 4, "length_m": 1, "initial_angle_deg": 30)");
  CHECK(std::get<Bundle>(bundle.spec(0).scene).initial_angle_deg == 30);
  CHECK(bundle.task(0).segments == 28);
}

TEST_CASE("a scene whose factor needs too much memory is refused before it runs, with what does without") {
  constexpr double little = 1e6;
  const auto refusal_of_factors = [](const Json& job) {
    return message_of<JobError>([&] { check_factors(plan_of(job), little); });
  };
  Json job = job_with_scene(R"("type": "lattice", "nodes_x": 4, "segments": 2, "mesh_m": 0.2, "radius_m": 0.01)");
  CHECK_THAT(refusal_of_factors(job),
             Catch::Contains("solve: task 0: a direct solve of 400 joints needs 0.00") &&
                 Catch::Contains("0.000931 GiB; must be a smaller scene, or method \"cg\" with "
                                 "\"reference\": \"cg\" (no factorisation)"));
  job["solve"]["reference"] = "cg";
  CHECK(refusal_of_factors(job) == "");
  job["guesses"] = Json::parse(R"(["zero", {"guarded": {"guess": {"oracle": {"error": 0.1}}, "threshold": 1}}])");
  CHECK_THAT(refusal_of_factors(job), Catch::Contains("guesses: task 0: ") && Catch::Contains("no \"oracle\""));
  job["guesses"] = {"zero"};
  job["scene"]["contact"] = Json::object();
  CHECK_THAT(refusal_of_factors(job), Catch::Contains("scene.contact: task 0: ") && Catch::Contains("without contact"));
  CHECK_NOTHROW(check_factors(plan_of(job)));
  // The memory of chains and trees grows linearly, so they are not checked.
  CHECK(refusal_of_factors(with("/scene/segments", "100000")) == "");
}

}  // namespace test_job_scenes
