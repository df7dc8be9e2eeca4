// Moving obstacles that carry, push, drag and press rods.
#include <cmath>

#include "tests/catch.hpp"
#include "tests/solver/support.hpp"
#include "tests/solver/touching.hpp"

namespace rodsweep::test_moving_obstacles {

using test::capsule;
using test::contact_scene;
using test::Touching;

constexpr double r = 0.05, g = 9.81, dt = 0.005;

Scene lying(const Vector3& velocity, double friction, const Obstacle& on) {
  Scene scene = contact_scene({capsule({-0.5, r, 0}, {0.5, r, 0}, velocity)}, friction, {0, -g, 0});
  scene.obstacles = {on};
  return scene;
}

/// A moving plane y = 0.
HalfSpace plate(const Vector3& velocity) { return {{0, 0, 0}, {0, 1, 0}, velocity}; }

TEST_CASE("a plate that sinks faster than a rod falls leaves it, and is overtaken") {
  Touching t(lying({0, 0, 0}, 0.3, plate({0, -1, 0})), dt);
  t.run(10);
  CHECK(t.scene.rods[0].velocity[0].y() == Approx(-10 * dt * g).epsilon(1e-9));
  CHECK(t.run(90) < 1e-4);
  CHECK(t.scene.rods[0].velocity[0].y() == Approx(-1).epsilon(1e-4));
}

TEST_CASE("a rod on a belt across it slides, then rolls with a third of the belt's speed, thin ones too") {
  const double friction = 0.4, speed = 1;
  for (const Integrator integrator : {Integrator::euler, Integrator::bdf2})
    for (const double radius : {2e-3, 0.01, 0.05}) {
      Scene scene = contact_scene({test::roller(2, radius)}, friction, {0, -g, 0});
      scene.obstacles = {plate({speed, 0, 0})};
      Touching t(scene, dt, integrator);
      t.run(10);
      CHECK(t.scene.rods[0].velocity[0].x() == Approx(10 * dt * friction * g).epsilon(2e-3));
      t.run(50);
      CHECK(t.scene.rods[0].velocity[0].x() == Approx(speed / 3).epsilon(5e-3));
      CHECK(t.scene.rods[0].angular_velocity[0].z() * radius == Approx(speed * 2 / 3).epsilon(5e-3));
    }
}

TEST_CASE("a ball or bar shot at a rod never passes through it, however fast") {
  for (const double speed : {1.0, 20.0, 300.0})
    for (const bool is_ball : {true, false}) {
      Scene scene = contact_scene({capsule({-0.5, 0, 0}, {0.5, 0, 0}, {0, 0, 0})});
      const Vector3 velocity(0, speed, 0);
      if (is_ball)
        scene.obstacles = {Ball{{0, -0.4, 0}, 0.1, velocity}};
      else
        scene.obstacles = {Capsule{{0, -0.4, -1}, {0, -0.4, 1}, 0.1, velocity}};
      Touching t(std::move(scene), dt);
      for (int step = 0; step < 100; ++step) {
        t.step();
        CHECK(t.scene.rods[0].position[0].y() - (-0.4 + t.scene.time_s * speed) > 0.149);
      }
      CHECK(t.scene.rods[0].velocity[0].y() == Approx(speed).epsilon(1e-3));
    }
}

TEST_CASE("a scene that moves along with its obstacle, or is lifted by it, is the one at rest") {
  const Vector3 along(0.7, 0.4, -0.3);
  for (const Vector3& sliding : {Vector3(0.5, -0.2, 0.4), Vector3(-0.5, 0, 0)}) {
    Touching still(lying(sliding, 0.3, plate({0, 0, 0})), dt);
    Touching moving(lying(sliding + along, 0.3, plate(along)), dt);
    for (int i = 0; i < 60; ++i) {
      still.step();
      moving.step();
      const Vector3 apart = moving.scene.rods[0].position[0] - still.scene.rods[0].position[0];
      CHECK((apart - moving.scene.time_s * along).norm() < 1e-7);
    }
  }
}

/// Contact force along y on all segments above or below the middle [N].
double contact_force(const Scene& scene, double middle, bool above, double step) {
  double sum = 0;
  const Rod& rod = scene.rods.front();
  for (std::size_t s = 0; s < rod.segments.size(); ++s)
    if ((rod.position[s].y() > middle) == above) sum += rod.contact_impulse[s][1];
  const double dt_c = constraint_dt(scene, step);
  return sum / (dt_c * dt_c);
}

TEST_CASE("a lattice between two plates is squeezed, and the plates press alike") {
  for (const auto cell : {Lattice::Cell::cubic, Lattice::Cell::body_centred, Lattice::Cell::octet}) {
    Lattice p = test::lattice_of(cell, 2, 3, Held::free);
    p.mesh_m = 0.2;
    p.radius_m = 0.02;
    p.youngs_modulus_pa = 1e6;
    p.torsion_modulus_pa = 4e5;
    p.damping_per_s = 20;
    p.gravity_m_s2.setZero();
    p.contact = ContactSettings{};
    p.obstacles = {HalfSpace{{0, -0.12, 0}, {0, 1, 0}, {0, 0.1, 0}}, HalfSpace{{0, 0.32, 0}, {0, -1, 0}, {0, -0.1, 0}}};
    const double step = 0.002;
    Touching t(build_scene(p), step);
    CHECK(t.run(600) < 5e-4);  // until the plates are 0.2 m apart; the free lattice is 0.24 m high
    CAPTURE(cell);
    const double up = contact_force(t.scene, 0.1, false, step), down = contact_force(t.scene, 0.1, true, step);
    CHECK(up > 1);
    CHECK(up == Approx(-down).epsilon(1e-4));
  }
}

TEST_CASE("obstacles of no finite velocity are refused") {
  Scene scene = build_scene(test::bending_rod(3));
  scene.contact = ContactSettings{};
  const Vector3 none(0, NAN, 0);
  for (const Obstacle& obstacle : {Obstacle(HalfSpace{{}, {0, 1, 0}, none}), Obstacle(Ball{{}, 1, none}),
                                   Obstacle(Capsule{{0, 0, 0}, {0, 0, 1}, 1, none})}) {
    scene.obstacles = {obstacle};
    CHECK_THROWS_WITH(TimeStepper(scene, {dt, 2, 1e-9}), "an obstacle's velocity is not finite");
  }
}

}  // namespace rodsweep::test_moving_obstacles
