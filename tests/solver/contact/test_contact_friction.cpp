// Coulomb friction against closed forms: slopes, rolling, spinning down.
#include <cmath>

#include "tests/catch.hpp"
#include "tests/solver/touching.hpp"

namespace rodsweep::test_contact_friction {

using test::capsule;
using test::contact_scene;
using test::Touching;

constexpr double r = 0.05, g = 9.81, dt = 0.005;

/// A capsule 40 steps after rest, on the plane y = 0 with gravity tilted towards +x.
Scene on_slope(double slope, double friction, const Vector3& axis) {
  const Vector3 at(0, r, 0);
  Scene scene = contact_scene({capsule(at - axis, at + axis, {0, 0, 0})}, friction,
                              g * Vector3(std::sin(slope), -std::cos(slope), 0));
  scene.obstacles = {HalfSpace{}};
  Touching t(scene, dt);
  CHECK(t.run(40) < 1e-4);
  return t.scene;
}

TEST_CASE("along a slope a capsule slides with g (sin - mu cos) above the angle of friction, and stays below it") {
  for (const double friction : {0.0, 0.2, 0.5}) {
    const double limit = std::atan(friction);
    for (const double beyond : {0.02, 0.1, 0.3}) {
      const double slope = limit + beyond;
      const Scene scene = on_slope(slope, friction, {0.5, 0, 0});
      const double acceleration = g * (std::sin(slope) - friction * std::cos(slope));
      CHECK(scene.rods[0].velocity[0].x() == Approx(40 * dt * acceleration).epsilon(2e-3));
    }
    for (const double below : {0.02, 0.1}) {
      if (friction == 0) continue;
      const Scene scene = on_slope(limit - below, friction, {0.5, 0, 0});
      CHECK(scene.rods[0].velocity[0].norm() < 1e-4);
      CHECK(std::abs(scene.rods[0].position[0].x()) < 1e-5);
    }
  }
}

TEST_CASE("across a slope a capsule slides when friction is less than a third of the slope") {
  const double slope = 0.4, friction = std::tan(slope) / 3 * 0.5;
  const Scene scene = on_slope(slope, friction, {0, 0, 0.5});
  CHECK(scene.rods[0].velocity[0].x() ==
        Approx(40 * dt * g * (std::sin(slope) - friction * std::cos(slope))).epsilon(5e-3));
}

TEST_CASE("a rod across a slope rolls with 2/3 g sin, however far it turns in a step, and gains no energy") {
  const double slope = 20 * pi / 180, acceleration = g * std::sin(slope) * 2 / 3, end_s = 0.6;
  const Vector3 gravity = g * Vector3(std::sin(slope), -std::cos(slope), 0);
  const auto roll = [&](int segments, double radius, double step_s, Integrator integrator, bool balance) {
    INFO(segments << " segments, radius " << radius << ", step " << step_s << ", balance " << balance << ", "
                  << (integrator == Integrator::euler ? "Euler" : "BDF2"));
    Scene scene = contact_scene({test::roller(segments, radius)}, 0.8, gravity);
    scene.obstacles = {HalfSpace{}};
    Touching t(scene, step_s, integrator, balance);
    const double scale = segments * scene.rods[0].segments[0].mass * std::pow(acceleration * end_s, 2);
    double slip = 0, gained = 0, energy = HUGE_VAL;
    while (t.scene.time_s < end_s - step_s / 2) {
      t.step();
      const Rod& rod = t.scene.rods[0];
      const double speed = acceleration * t.scene.time_s;
      if (speed * step_s < 7 * radius)  // about half a turn
        slip = std::max(
            {slip, std::abs(rod.velocity[0].x() - speed), std::abs(rod.angular_velocity[0].z() * radius + speed)});
      double now = test::kinetic_energy(t.scene);
      for (int s = 0; s < segments; ++s) now -= rod.segments[s].mass * gravity.dot(rod.position[s]);
      gained = std::max(gained, now - energy);
      energy = now;
    }
    CHECK(slip < 2e-3 * acceleration * end_s);
    CHECK(gained < 1e-4 * scale);
  };
  for (const Integrator integrator : {Integrator::euler, Integrator::bdf2})
    for (const bool balance : {false, true})
      for (const int segments : {1, 2})
        for (const double radius : {5e-5, 1e-3, 0.01, 0.1})
          for (const double step_s : {5e-4, 5e-3, 2e-2})
            if (g * step_s * step_s < 4.5 * radius) roll(segments, radius, step_s, integrator, balance);
}

TEST_CASE("friction between rods and with obstacles are two numbers") {
  const Vector3 along(0.4, 0, 0), gravity = g * Vector3(0.2, -1, 0).normalized();
  const double fallen = 40 * dt * gravity.x();
  for (const double rods : {0.0, 0.5})
    for (const double obstacle : {0.0, 0.5}) {
      Scene scene = contact_scene({capsule(Vector3(0, r, 0) - along, Vector3(0, r, 0) + along, {0, 0, 0}),
                                   capsule(Vector3(0, r, 2 * r) - along, Vector3(0, r, 2 * r) + along, {0, 0, 0}),
                                   capsule(Vector3(0, (1 + std::sqrt(3)) * r, r) - along,
                                           Vector3(0, (1 + std::sqrt(3)) * r, r) + along, {0, 0, 0})},
                                  rods, gravity);
      const double side = 2 * r;  // walls keep the lower two together
      scene.obstacles = {HalfSpace{}, HalfSpace{{0, 0, -r}, {0, 0, 1}}, HalfSpace{{0, 0, side + r}, {0, 0, -1}}};
      scene.contact->obstacle_friction = obstacle;
      Touching t(scene, dt);
      t.run(40);
      const double below = t.scene.rods[0].velocity[0].x(), above = t.scene.rods[2].velocity[0].x();
      INFO("rods " << rods << ", obstacle " << obstacle);
      CHECK((below < 1e-3) == (obstacle > 0));
      CHECK((above - below < 1e-3) == (rods > 0 || obstacle == 0));
      if (obstacle == 0) CHECK(below == Approx(fallen).epsilon(2e-3));
    }
}

/// How far a limp rod over a fixed capsule slips in half a second. Its ends are pulled down with 1 N and `ratio` N.
double slip_of_rope(double friction, double ratio) {
  RodParameters p;
  p.radius_m = 0.01;
  p.youngs_modulus_pa = 1e4;
  p.torsion_modulus_pa = 1e4;
  constexpr int arc = 48, leg = 10;
  const double drum = 0.2, bent = (drum + p.radius_m) / std::cos(pi / (2 * arc)),
               length = 2 * bent * std::sin(pi / (2 * arc));
  std::vector<Vector3> vertices;
  for (int i = leg; i > 0; --i) vertices.emplace_back(-bent, -i * length, 0);
  for (int i = 0; i <= arc; ++i)
    vertices.emplace_back(-bent * std::cos(i * pi / arc), bent * std::sin(i * pi / arc), 0);
  for (int i = 1; i <= leg; ++i) vertices.emplace_back(bent, -i * length, 0);
  const std::vector<SegmentSpec> segments = segments_through(vertices, p);
  Scene scene = contact_scene({chain(segments, p, ratio)}, friction);
  scene.obstacles = {Capsule{{0, 0, -1}, {0, 0, 1}, drum}};
  scene.loads = {{0, 0, {0, -1, 0}}, {0, static_cast<int>(segments.size()) - 1, {0, -ratio, 0}}};
  scene.damping_per_s = 2;
  Touching t(scene, 0.002);
  const double before = t.scene.rods[0].position.back().y();
  CHECK(t.run(250) < 0.01);
  return before - t.scene.rods[0].position.back().y();
}

TEST_CASE("a rope over half a drum holds a load of up to exp(mu pi) times the other (Euler 1769; Eytelwein 1808)") {
  for (const double friction : {0.2, 0.4}) {
    const double most = std::exp(friction * pi);
    CHECK(std::abs(slip_of_rope(friction, 0.92 * most)) < 2e-3);
    CHECK(slip_of_rope(friction, 1.05 * most) > 0.02);
  }
}

}  // namespace rodsweep::test_contact_friction
