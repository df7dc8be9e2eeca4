// Loads and motions of clamps and gravity over time.
#include <memory>

#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/stepping.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_prescribed {

using Catch::Matchers::ContainsSubstring;

const Vector3 none(0, 0, 0);
const Schedule ramp{{0, 1}, {0, 1}, false};  ///< from zero to all of it in a second

TEST_CASE("a schedule is linear or smooth between its times and constant outside") {
  Schedule linear{{1, 2, 4}, {0, 3, 1}, false}, smooth = linear;
  smooth.smooth = true;
  for (const Schedule& of : {linear, smooth}) {
    CHECK(of.at(0) == 0);
    CHECK(of.at(1) == 0);
    CHECK(of.at(2) == 3);
    CHECK(of.at(9) == 1);
    CHECK(of.at(1.5) == Approx(1.5));
    CHECK(of.at(3) == Approx(2));
    CHECK(of.largest() == 3);
  }
  CHECK(linear.at(1.1) == Approx(0.3));
  CHECK(smooth.at(1 + 1e-4) < 1e-10);  // no speed
  CHECK(Schedule().at(7) == 1);
  CHECK_THROWS_WITH((Schedule{{0, 1}, {1}, false}.check()), ContainsSubstring("times_s has 2 values, factors 1"));
  CHECK_THROWS_WITH((Schedule{{0, 0}, {1, 1}, false}.check()), ContainsSubstring("greater than the one before"));
}

TEST_CASE("a constant load at the tip is the tip's force and torque") {
  BendingRod tip = test::bending_rod(12), point = tip;
  tip.tip_force_n = {0.1, -0.2, 0.05};
  tip.tip_torque_nm = {0.01, 0, 0.02};
  const Vector3 end = tip.vertex_m(12);
  point.prescribed.loads.push_back({end, tip.tip_force_n, tip.tip_torque_nm, {}});
  for (const std::optional<double> balance : {std::optional<double>(), std::optional<double>(1e-8)}) {
    Simulation one(build_scene(tip), 0.01, 12, balance), other(build_scene(point), 0.01, 12, balance);
    for (PointLoad& load : other.scene.loads) load.arm_m = one.scene.loads.front().arm_m;  // not rounded
    one.run(20);
    other.run(20);
    CHECK(test::distance(one.scene, other.scene, &Rod::position) < 1e-9);
  }
}

TEST_CASE("forces and gravity over time move a free body as their integral does") {
  Scene scene = test::free_body();
  const double mass = scene.rods[0].segments[0].mass, dt = 0.01;
  Prescribed all;
  all.loads.push_back({scene.rods[0].position[0], {mass, 0, 0}, none, ramp});
  all.gravity.push_back({{0, 3, 0}, ramp});
  add_prescribed(all, scene);
  Simulation simulation(scene, dt);
  simulation.run(100);
  // The sum of factors at the ends of steps.
  CHECK((simulation.rod().velocity[0] - (1 + dt) * Vector3(0.5, 1.5, 0)).norm() < 1e-12);
  CHECK(simulation.scene.gravity_at(0.5) == Vector3(0, 1.5, 0));
}

TEST_CASE("a smooth motion of a clamp is the motion of a tip") {
  BendingRod tip = test::bending_rod(12, Clamp::wall);
  tip.stretch = Stretch::physical;
  tip.tip_motion = TipMotion{{-0.2, 0.1, 0}, {0, 0, 90}, 0.1};
  const Scene expected = build_scene(tip);
  Scene scene = expected;
  scene.clamps.clear();
  Prescribed moved;
  const Vector3 end = tip.vertex_m(12);
  // In two parts, which add up.
  const Schedule schedule{{0, 0.1}, {0, 1}, true};
  moved.motions.push_back({end, {-0.2, 0, 0}, {0, 0, 90}, schedule});
  moved.motions.push_back({end, {0, 0.1, 0}, {0, 0, 0}, schedule});
  add_prescribed(moved, scene);
  Simulation one(expected, 0.01), other(scene, 0.01);
  one.run(15);
  other.run(15);
  CHECK(test::distance(one.scene, other.scene, &Rod::position) < 1e-9);
}

/// The centre of the first segment, one metre along x from the origin and held, when these motions have ended.
Vector3 moved_centre(const std::vector<PrescribedMotion>& motions) {
  BendingRod rod = test::bending_rod(4);
  rod.length_m = 4;
  rod.initial_angle_deg = 0;
  rod.prescribed.motions = motions;
  return build_scene(rod).clamps.front().pose(1).position;
}

TEST_CASE("several motions of one clamp each turn about their own point, in any order") {
  const PrescribedMotion shift{none, {0, 0.1, 0}, none, ramp}, turn{{1, 0, 0}, none, {0, 0, 90}, ramp},
      half{{1, 0, 0}, none, {0, 0, 45}, ramp}, back{{0.2, 0, 0}, {0, -0.1, 0}, none, ramp},
      along{{1, 0, 0.02}, none, {0, 0, 90}, ramp}, other{{0.5, 0, 0}, none, {0, 0, 90}, ramp};
  const Vector3 turned(1, -0.5, 0);
  for (const auto& [motions, expected] :
       {std::pair(std::vector{turn}, turned), std::pair(std::vector{shift, turn}, Vector3(turned + Vector3(0, 0.1, 0))),
        std::pair(std::vector{shift, half, back, half}, turned),
        std::pair(std::vector{turn, along}, Vector3(1.5, 0, 0))}) {  // points of one axis
    std::vector<PrescribedMotion> reversed(motions.rbegin(), motions.rend());
    CHECK((moved_centre(motions) - expected).norm() < 1e-12);
    CHECK((moved_centre(reversed) - expected).norm() < 1e-12);
  }
  for (const auto& both : {std::vector{turn, other}, {other, turn}})
    CHECK_THROWS_WITH(moved_centre(both), ContainsSubstring("motions of one clamp turn about different points: [") &&
                                              ContainsSubstring("must be one point or points of one axis"));
}

TEST_CASE("points of loads and motions may be rounded") {
  Net net;  // its corners are held at points
  net.rows = net.columns = 4;
  net.stretch = Stretch::physical;
  const double rounded = 3 * net.mesh_m;
  net.prescribed.motions.push_back({{rounded * (1 + 1e-8), 1e-9, 0}, {0, 0.1, 0}, none, ramp});
  const Scene scene = build_scene(net);
  REQUIRE(scene.clamps.size() == 1);
  CHECK((scene.clamps[0].pose(1).position - Vector3(rounded, 0.1, 0)).norm() < 1e-12);
  net.prescribed.motions[0].at_m.x() *= 1.001;
  CHECK_THROWS_WITH(build_scene(net), ContainsSubstring("m away from the nearest segment"));
}

/// A curve of two legs of 0.5 m in pieces of 0.1 m, held at both ends, under these motions.
Curves between_ends(const std::vector<PrescribedMotion>& motions, Stretch stretch) {
  Curves p;
  static_cast<RodParameters&>(p) = test::bending_rod(10);
  p.stretch = stretch;
  p.curves = std::make_shared<const std::vector<Curve>>(
      std::vector{Curve{"curve", {{0, 0, 0}, {0.5, 0, 0}, {0.5, 0, 0.5}}, {}, {}, {}, {}}});
  p.how.segment_m = 0.1;
  p.how.held = HeldPoints::ends;
  p.prescribed.motions = motions;
  return p;
}

TEST_CASE("motions that pull a rod apart are refused unless it stretches") {
  const Schedule schedule{{0, 1, 2}, {0, 1, 0}, false};
  const Vector3 a(0, 0, 0), b(0.5, 0, 0.5);
  const auto pulled = [&](double by, Stretch stretch) {  // they are 0.707 m apart, along a rod of 1 m
    const Vector3 along = by / 2 * (b - a).normalized();
    return between_ends({{b, along, none, schedule}, {a, -along, none, schedule}}, stretch);
  };
  CHECK_NOTHROW(build_scene(pulled(0.29, Stretch::inextensible)));
  CHECK_THROWS_WITH(
      build_scene(pulled(0.3, Stretch::inextensible)),
      ContainsSubstring("motions of the clamps at [0, 0, 0] and [0.5, 0, 0.5] pull the rod between them to 1.007") &&
          ContainsSubstring("must be at most its length, 1.000000 m, or \"stretch\" must be \"physical\""));
  CHECK_NOTHROW(build_scene(pulled(0.3, Stretch::physical)));
}

TEST_CASE("motions that turn a joint by more than a right angle are refused") {
  const auto turned = [&](double one_deg, double other_deg) {  // 11 joints
    return between_ends({{none, none, {one_deg, 0, 0}, ramp}, {{0.5, 0, 0.5}, none, {other_deg, 0, 0}, ramp}},
                        Stretch::physical);
  };
  CHECK_NOTHROW(build_scene(turned(989, 0)));
  CHECK_NOTHROW(build_scene(turned(2000, 1100)));
  CHECK_THROWS_WITH(build_scene(turned(600, -400)),
                    ContainsSubstring("turn them against each other by 1000") &&
                        ContainsSubstring("must be at most 90 for each of the 11 joints between them"));
  BendingRod tip = test::bending_rod(10, Clamp::wall);
  tip.stretch = Stretch::physical;
  tip.tip_motion = TipMotion{none, {1000, 0, 0}, 1};
  CHECK_THROWS_WITH(build_scene(tip),
                    ContainsSubstring("tip_motion turns the end by 1000") && ContainsSubstring("each of 11 joints"));
}

TEST_CASE("loads stiffen all inextensible joints of a rod alike, those of crossings too") {
  Lattice lattice = test::lattice_of(Lattice::Cell::cubic, 3);
  lattice.stretch = Stretch::inextensible;
  Net net;
  for (SceneSpec spec : {SceneSpec(lattice), SceneSpec(net)}) {
    const Scene plain = build_scene(spec);
    const Rod& before = plain.rods.front();
    std::size_t free = 0;
    while (before.segments[free].is_static) ++free;
    std::visit(
        [&](auto& scene) {
          scene.prescribed.loads.push_back({before.position[free], {0, 50, 0}, {0, 0, 0}, {}});
        },
        spec);
    const Scene loaded = build_scene(spec);
    const double ratio = before.joints[0].compliance[0] / loaded.rods.front().joints[0].compliance[0];
    CHECK(ratio > 1);
    for (std::size_t k = 0; k < before.joints.size(); ++k)
      CHECK(before.joints[k].compliance[0] == Approx(ratio * loaded.rods.front().joints[k].compliance[0]));
  }
}

TEST_CASE("points away from rods and motions of free segments are refused") {
  BendingRod away = test::bending_rod(10), free = away;
  away.prescribed.loads.push_back({{0, 5, 0}, {1, 0, 0}, none, {}});
  free.prescribed.motions.push_back({free.vertex_m(10), {1, 0, 0}, none, ramp});
  CHECK_THROWS_WITH(build_scene(away), ContainsSubstring("a load at [0, 5, 0] is") &&
                                           ContainsSubstring("m away from the nearest segment"));
  CHECK_THROWS_WITH(build_scene(free), ContainsSubstring("a motion of a clamp at") &&
                                           ContainsSubstring("m away from the nearest segment"));
}

}  // namespace rodsweep::test_prescribed
