// Steps with contacts: their reports, the state that they keep, their failures.
#include <catch2/catch.hpp>
#include <limits>

#include "tests/solver/touching.hpp"

namespace rodsweep::test_contact_steps {

using test::capsule;
using test::contact_scene;
using test::Touching;

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
  const double tolerance = t.scene.contact->tolerance;
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
    DirectSolve direct(scene);
    LinearProjection projection(scene, direct);
    TimeStepper stepper(scene, {});
    CHECK(stepper.step(projection).outcome == SolveOutcome::not_a_number);
    CHECK(scene.rods[0].position[0].allFinite());
  }
}

}  // namespace rodsweep::test_contact_steps
