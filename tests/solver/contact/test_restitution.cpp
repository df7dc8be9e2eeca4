// The law of restitution at every phase of the step: heights of bounces, energy, momentum, rest.
//
// Both schemes are exact in flight, except for the steps of Euler in which BDF2 starts (rebound.hpp). So each apex differs
// from e^2 times the one before by at most g dt^2, the fall in the first step of Euler.
#include <algorithm>
#include <cmath>
#include <utility>

#include "tests/catch.hpp"
#include "tests/solver/touching.hpp"

namespace rodsweep::test_restitution {

using test::capsule;
using test::contact_scene;
using test::straight_rod;
using test::Touching;

constexpr double r = 0.05, g = 9.81;  // the radius is that of RodParameters
constexpr Integrator schemes[] = {Integrator::euler, Integrator::bdf2};
constexpr int phases = 40;
constexpr double unconverged = 1e-5;  ///< of the energy, by what Newton's iteration leaves in an impact

/// A level rod of 1 m above a floor. Its ends are `tilt` above and below `from_m`.
Scene dropped(double from_m, double restitution, int segments, double tilt = 0) {
  RodParameters p;
  p.youngs_modulus_pa = 1e7;
  p.torsion_modulus_pa = 4e6;
  Scene scene = contact_scene({straight_rod({-0.5, r + from_m - tilt, 0}, {0.5, r + from_m + tilt, 0}, segments, p)},
                              0.3, {0, -g, 0});
  scene.obstacles = {HalfSpace{}};
  scene.contact->restitution = restitution;
  scene.contact->tolerance = 1e-9;
  return scene;
}

/// Of the centre above its place on the floor.
double height(const Scene& scene) {
  Vector3 sum = Vector3::Zero();
  for (const Vector3& position : scene.rods[0].position) sum += position;
  return sum.y() / scene.rods[0].segment_count() - r;
}

/// What a step keeps in free flight: for Euler, the energy and dt / 2 g.P (rebound.hpp: b0).
double kept_energy(const Scene& scene, Integrator integrator, double dt) {
  const double shift = integrator == Integrator::euler ? dt / 2 : 0;
  return mechanical_energy(scene) + shift * scene.gravity_m_s2.dot(test::linear_momentum(scene));
}

double mass(const Rod& rod) {
  double sum = 0;
  for (const Segment& segment : rod.segments) sum += segment.mass;
  return sum;
}

TEST_CASE("a dropped rod rises by e^2 after each bounce and never gains energy, at all phases of the step") {
  constexpr double dt = 5e-3, first_fall = g * dt * dt;
  for (const Integrator integrator : schemes)
    for (const bool balance : {false, true})
      for (const double e : {0.0, 0.3, 0.6, 1.0})
        for (int phase = 0; phase < phases; ++phase) {
          const double from = 0.3 + 0.00053 * phase;  // in its last step a rod falls by .012 m
          Touching t(dropped(from, e, phase % 2 ? 1 : 3), dt, integrator, balance);
          INFO("BDF2 " << (integrator == Integrator::bdf2) << ", balance " << balance << ", e " << e << ", from "
                       << from);
          const double fall_s = std::sqrt(2 * from / g), rest_s = e < 1 ? fall_s * (1 + e) / (1 - e) : HUGE_VAL;
          const double start = g * from * mass(t.scene.rods[0]);
          // An impact of BDF2 gives what its next two steps will take (rebound.hpp: c).
          const double ahead = integrator == Integrator::bdf2 ? 1.25 * g * g * dt * dt * mass(t.scene.rods[0]) : 0;
          double apex = from, before = from, last = from, energy = kept_energy(t.scene, integrator, dt), gained = 0;
          int bounces = 0;
          while (t.scene.time_s < std::min(0.8, 1.2 * rest_s)) {
            t.step();
            const double now = height(t.scene), is = kept_energy(t.scene, integrator, dt);
            gained = std::max(gained, is - std::exchange(energy, is));
            if (last >= before && last > now && t.scene.time_s > fall_s) {
              apex *= e * e;
              if (apex > 12 * first_fall) CHECK(std::abs(last - apex) < ++bounces * first_fall);
            }
            before = std::exchange(last, now);
          }
          CHECK(gained < unconverged * start + ahead);
          if (e == 1) CHECK(bounces > 0);
          if (1.2 * rest_s < 0.8) CHECK(std::abs(last) + std::abs(last - before) < 1e-6);
        }
}

// Which of its contacts closes first is a matter of rounding: each has to separate as if they all did.
TEST_CASE("a rod that falls nearly flat rebounds with both ends if only one would reach the floor in the step") {
  constexpr double dt = 2e-3, e = 0.6;
  constexpr int steps = 160;
  for (const Integrator integrator : schemes)
    for (const int segments : {1, 4})
      for (const double tilt : {1e-9, 1e-6, 1e-4})
        for (const auto& [above, newton_iterations] :
             {std::pair(-1e-4, 6), {-1e-6, 10}, {-1e-9, 6}, {0.0, 10}, {1e-9, 6}, {1e-6, 10}, {1e-4, 6}}) {
          const double fallen = g * dt * dt / 2 * steps * (integrator == Integrator::euler ? steps + 1 : steps);
          INFO("BDF2 " << (integrator == Integrator::bdf2) << ", segments " << segments << ", tilt " << tilt
                       << ", above " << above);
          Simulation t(dropped(fallen + above, e, segments, tilt), {dt, newton_iterations, 1e-9, integrator});
          t.run(steps - 3);
          const double before = test::linear_momentum(t.scene).y();
          t.run(8);
          const double after = test::linear_momentum(t.scene).y();
          CHECK(after == Approx(-e * before).margin(8 * dt * g * mass(t.scene.rods[0])));  // gravity in these steps
        }
}

TEST_CASE("two rods that collide keep their momentum and part with e of their approach, at all phases of the step") {
  constexpr double dt = 5e-3;
  RodParameters p;
  p.youngs_modulus_pa = 1e7;
  p.torsion_modulus_pa = 4e6;
  RodParameters heavy = p;
  heavy.density_kg_m3 = 3000;
  for (const Integrator integrator : schemes)
    for (const bool balance : {false, true})
      for (const double e : {0.0, 0.3, 0.6, 1.0})
        for (int phase = 0; phase < phases; ++phase) {
          const double apart = 2 * r + 0.03 + 0.015 / phases * phase;  // they approach by .015 m in a step
          const int segments = phase % 2 ? 1 : 4;
          Scene scene = contact_scene({straight_rod({0, 0, -1}, {0, 0, 2}, segments, heavy),
                                       straight_rod({apart, 0, -1}, {apart, 0, 2}, segments, p)});
          scene.contact->restitution = e;
          scene.contact->tolerance = 1e-9;
          for (Vector3& velocity : scene.rods[0].velocity) velocity = {2, 0, 0};
          for (Vector3& velocity : scene.rods[1].velocity) velocity = {-1, 0, 0};
          const Vector3 momentum = test::linear_momentum(scene);
          const double energy = test::kinetic_energy(scene);
          Touching t(scene, dt, integrator, balance);
          t.run(10);
          INFO("BDF2 " << (integrator == Integrator::bdf2) << ", balance " << balance << ", e " << e << ", segments "
                       << segments << ", apart " << apart);
          CHECK((test::linear_momentum(t.scene) - momentum).norm() < 1e-12 * momentum.norm());
          const Vector3 common = momentum / (mass(t.scene.rods[0]) + mass(t.scene.rods[1]));
          const double expected[] = {common.x() - e * 3 / 4, common.x() + e * 9 / 4};
          for (int rod = 0; rod < 2; ++rod)
            for (const Vector3& velocity : t.scene.rods[rod].velocity)
              CHECK((velocity - Vector3(expected[rod], 0, 0)).norm() < 1e-3);
          CHECK(test::kinetic_energy(t.scene) < (1 + unconverged) * energy);
          if (e == 0) CHECK(test::nearest(t.scene) == Approx(1).epsilon(1e-3));
        }
}

TEST_CASE("what lies on a floor or on another rod stays there with any restitution") {
  for (const Integrator integrator : schemes)
    for (const bool balance : {false, true})
      for (const double e : {0.3, 1.0}) {
        Scene scene = dropped(0, e, 4);
        scene.rods.push_back(capsule({0.2, 3 * r, -0.1}, {0.2, 3 * r, 0.1}, {0, 0, 0}));
        Touching t(scene, 5e-3, integrator, balance);
        INFO("BDF2 " << (integrator == Integrator::bdf2) << ", balance " << balance << ", e " << e);
        for (int i = 0; i < 100; ++i) {
          t.step();
          CHECK(std::abs(height(t.scene)) < 1e-4 * r);
          CHECK(std::abs(t.scene.rods[1].position[0].y() - 3 * r) < 1e-3 * r);
        }
      }
}

TEST_CASE("rods without joints move in the same way with the balance of momentum") {
  for (const Integrator integrator : schemes) {
    Scene scene = dropped(0.1, 0.6, 1, 0.05);
    scene.rods.push_back(capsule({0.1, 0.3, -0.3}, {0.2, 0.35, 0.3}, {0, 0, 0}));
    Touching with(scene, 5e-3, integrator, true), without(scene, 5e-3, integrator);
    for (int i = 0; i < 200; ++i) {
      with.step();
      without.step();
      for (int rod = 0; rod < 2; ++rod)
        REQUIRE((with.scene.rods[rod].position[0] - without.scene.rods[rod].position[0]).norm() < 1e-9);
    }
  }
}

/// Heights of a capsule's centre above its radius, dropped on a floor.
std::vector<double> bouncing(double from_m, double restitution, double dt, Integrator integrator, bool balance,
                             double duration_s) {
  const Vector3 at(0, r + from_m, 0), along(0.5, 0, 0);
  Scene scene = contact_scene({capsule(at - along, at + along, {0, 0, 0})}, 0.3, {0, -9.81, 0});
  scene.obstacles = {HalfSpace{}};
  scene.contact->restitution = restitution;
  Touching t(scene, dt, integrator, balance);
  std::vector<double> heights;
  for (double s = 0; s < duration_s; s += dt) {
    t.step();
    heights.push_back(t.scene.rods[0].position[0].y() - r);
  }
  return heights;
}

TEST_CASE("a capsule rises by the square of the restitution after each bounce, and rests when it is due") {
  for (const Integrator integrator : {Integrator::euler, Integrator::bdf2})
    for (const double restitution : {0.0, 0.6, 0.9, 1.0})
      for (const double dt : {2e-3, 5e-3, 1e-2})
        for (const double from_m : {0.5, 0.4712}) {
          const double rest_s = std::sqrt(2 * from_m / 9.81) * (1 + restitution) / (1 - restitution);
          const bool balance = restitution == 0 && from_m == 0.5;
          const std::vector<double> heights =
              bouncing(from_m, restitution, dt, integrator, balance, std::min(8.0, 1.3 * rest_s));
          INFO("BDF2 " << (integrator == Integrator::bdf2) << ", e " << restitution << ", dt " << dt << ", from "
                       << from_m);
          double apex = from_m, moved_s = 0;
          for (std::size_t i = 1; i + 1 < heights.size(); ++i) {
            if (std::abs(heights[i + 1] - heights[i]) > 2e-6) moved_s = dt * static_cast<double>(i + 1);
            if (!(heights[i] >= heights[i - 1] && heights[i] > heights[i + 1])) continue;
            apex *= restitution * restitution;
            if (apex > 600 * dt * dt) CHECK(heights[i] == Approx(apex).epsilon(0.01));  // 20 steps of flight
          }
          CHECK(*std::min_element(heights.begin(), heights.end()) > -1e-4);
          if (restitution < 1) CHECK(moved_s == Approx(rest_s).epsilon(dt < 0.01 ? 0.1 : 0.2));
        }
}

}  // namespace rodsweep::test_restitution
