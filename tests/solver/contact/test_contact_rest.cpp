// Rods at rest penetrate by at most 1 % of the radius; what steps with contacts report, keep and refuse.
#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/catch.hpp"
#include "tests/solver/stepping.hpp"
#include "tests/solver/touching.hpp"

namespace rodsweep::test_contact_rest {

using test::contact_scene;
using test::straight_rod;
using test::Touching;

RodParameters material(double youngs_modulus_pa) {
  RodParameters p;
  p.radius_m = 0.02;
  p.youngs_modulus_pa = youngs_modulus_pa;
  p.torsion_modulus_pa = youngs_modulus_pa / 2.6;
  return p;
}

/// Layers of three parallel rods on a floor, each at right angles to the one below.
Scene stack(int layers, int segments, double youngs_modulus_pa) {
  const RodParameters p = material(youngs_modulus_pa);
  const double r = p.radius_m;
  std::vector<Rod> rods;
  for (int layer = 0; layer < layers; ++layer)
    for (int k = 0; k < 3; ++k) {
      const double y = r + 2 * r * layer, at = 0.2 + 0.3 * k;
      rods.push_back(layer % 2 ? straight_rod({at, y, 0}, {at, y, 1}, segments, p)
                               : straight_rod({0, y, at}, {1, y, at}, segments, p));
    }
  Scene scene = contact_scene(rods, 0.3, {0, -9.81, 0});
  scene.obstacles = {HalfSpace{}};
  return scene;
}

TEST_CASE("a stack of rods comes to rest and does not sink in") {
  for (const double youngs_modulus_pa : {1e8, 1e9}) {
    INFO("E = " << youngs_modulus_pa);
    Touching t(stack(3, 10, youngs_modulus_pa), 0.01);
    t.run(40);
    const Scene settled = t.scene;
    CHECK(t.run(40) < 0.01);
    for (std::size_t rod = 0; rod < settled.rods.size(); ++rod)  // rolling is free
      for (std::size_t s = 0; s < 10; ++s)
        CHECK(std::abs(t.scene.rods[rod].position[s].y() - settled.rods[rod].position[s].y()) < 0.02 * 0.02);
    for (const Rod& rod : t.scene.rods)
      for (const Vector3& v : rod.velocity) CHECK(std::abs(v.y()) < 0.01);
  }
}

TEST_CASE("two Newton iterations still keep a stack from sinking in") {
  Touching t(stack(3, 10, 1e7), 0.01, 2);
  t.run(60);
  CHECK(t.run(40) < 0.01);
}

/// Parallel rods of six segments between walls: three, two on these, one on top.
Scene pile() {
  const RodParameters p = material(1e7);
  const double r = p.radius_m;
  std::vector<Rod> rods;
  for (int layer = 0; layer < 3; ++layer)
    for (int k = 0; k < 3 - layer; ++k) {
      const double y = r + std::sqrt(3) * r * layer, z = 2 * r * k + r * layer;
      rods.push_back(straight_rod({0, y, z}, {1, y, z}, 6, p));
    }
  Scene scene = contact_scene(rods, 0.3, {0, -9.81, 0});
  scene.obstacles = {HalfSpace{}, HalfSpace{{0, 0, -r}, {0, 0, 1}}, HalfSpace{{0, 0, 5 * r}, {0, 0, -1}}};
  return scene;
}

TEST_CASE("a pile of parallel rods between walls rests with line contacts") {
  const Scene scene = pile();
  Touching t(scene, 0.01);
  t.run(30);
  CHECK(t.run(30) < 0.01);
  CHECK(test::distance(scene, t.scene, &Rod::position) < 0.01 * 0.02);  // radii of 0.02 m
}

// 6000 steps: if each moved a contact by the tolerance in the same direction, this would be 6000 tolerances.
TEST_CASE("a pile at rest does not creep in a minute by what its contacts' tolerance leaves", "[.long]") {
  for (const Integrator integrator : {Integrator::euler, Integrator::bdf2})
    for (const bool balance : {false, true})
      for (const double tolerance : {1e-5, 1e-4, 1e-3}) {
        Scene scene = pile();
        scene.contact->tolerance = tolerance;
        Touching t(scene, 0.01, integrator, balance);
        t.run(100);
        const Scene settled = t.scene;
        INFO("BDF2 " << (integrator == Integrator::bdf2) << ", balance " << balance << ", tolerance " << tolerance);
        CHECK(t.run(6000) < 10 * tolerance);
        CHECK(test::distance(settled, t.scene, &Rod::position) < 50 * tolerance * 0.02);
      }
}

TEST_CASE("a beam on two supports bends between them and sinks into neither") {
  const RodParameters p = material(1e8);
  const double r = p.radius_m;
  Scene scene = contact_scene({straight_rod({0, 2 * r, 0}, {1, 2 * r, 0}, 30, p)}, 0.3, {0, -9.81, 0});
  for (const double x : {0.1, 0.9}) scene.obstacles.push_back(Capsule{{x, 0, -1}, {x, 0, 1}, r});
  scene.damping_per_s = 5;
  Touching t(scene, 0.01);
  t.run(150);
  CHECK(t.run(20) < 0.01);
  // 5 q L^4 / 384 EI of the span, minus the lift by the overhanging ends: q a^2 / 2 L^2 / 8 EI.
  const double area = pi * r * r, ei = 1e8 * pi * std::pow(r, 4) / 4, q = 1000 * 9.81 * area;
  const double sag = q / ei * (5 * std::pow(0.8, 4) / 384 - 0.1 * 0.1 / 2 * 0.8 * 0.8 / 8);
  const Rod& rod = t.scene.rods[0];
  CHECK(2 * r - (rod.position[14].y() + rod.position[15].y()) / 2 == Approx(sag).epsilon(0.05));
}

using test::capsule;

constexpr double r = 0.05;  // of RodParameters

/// Two rods of six segments, one on a floor, the other falls on it crosswise.
Scene crossed(int sweeps) {
  RodParameters p;
  p.youngs_modulus_pa = 1e6;
  Scene scene = contact_scene({test::straight_rod({0, r, 0.5}, {1, r, 0.5}, 6, p),
                               test::straight_rod({0.5, 3.1 * r, 0}, {0.5, 3.1 * r, 1}, 6, p)},
                              0.3, {0, -9.81, 0});
  scene.obstacles = {HalfSpace{}};
  scene.contact->sweeps = sweeps;
  return scene;
}

TEST_CASE("a step says how far its contacts are from where they want to be") {
  Touching t(crossed(100), 0.01, 30), cut_short(crossed(1), 0.01, 2);
  const double tolerance = t.scene.contact->tolerance_in(0.01);
  double left = 0;
  for (int i = 0; i < 30; ++i) {
    const StepReport report = t.step();
    CHECK(report.newton_iterations < 30);
    CHECK(report.contacts > 0);
    CHECK(report.contact_residual < tolerance);
    CHECK(report.penetration < 0.01);
    left = std::max(left, cut_short.step().contact_residual);
  }
  CHECK(left > 100 * tolerance);
}

TEST_CASE("contacts that part and meet again remember nothing: the step is that of a new simulation, bit for bit") {
  Touching t(crossed(100), 0.01, 2);  // too few iterations for a result that is independent of the start
  t.run(10);
  const Scene touching = t.scene;
  for (Rod& rod : t.scene.rods)
    for (Vector3& position : rod.position) position.y() += 5 + (&rod == &t.scene.rods[0]);
  CHECK(t.step().contacts == 0);
  t.scene.rods = touching.rods;
  Touching fresh(touching, 0.01, 2);
  CHECK(t.step().contacts > 0);
  fresh.step();
  for (std::size_t rod = 0; rod < 2; ++rod) {
    CHECK(t.scene.rods[rod].position == fresh.scene.rods[rod].position);
    CHECK(t.scene.rods[rod].angular_velocity == fresh.scene.rods[rod].angular_velocity);
  }
}

TEST_CASE("what is not finite ends the step before it can touch anything") {
  for (const double wild : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    Scene scene =
        contact_scene({capsule({0, r, 0}, {1, r, 0}, {0, 0, 0}), capsule({0, 3 * r, 0}, {1, 3 * r, 0}, {0, 0, 0})});
    scene.obstacles = {HalfSpace{}, Ball{{0.5, -1, 0}, 1}};
    scene.rods[1].velocity[0].x() = wild;  // of a single segment, which has no linear system
    Simulation simulation(scene, StepSettings{});
    CHECK(simulation.try_step().outcome == SolveOutcome::not_a_number);
    CHECK(simulation.rod().position[0].allFinite());
  }
}

}  // namespace rodsweep::test_contact_rest
