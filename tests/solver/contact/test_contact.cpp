// Collisions: impulses of rigid bodies, momentum, energy, no tunnelling.
#include <cmath>

#include "solver/numbers/rotation.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"
#include "tests/solver/touching.hpp"

namespace rodsweep::test_contact {

using test::capsule;
using test::contact_scene;
using test::Touching;

constexpr double r = 0.05;  // of RodParameters

/// A tolerance for closed forms.
Scene exact(Scene scene) {
  scene.contact->tolerance = 1e-9;
  return scene;
}

/// One step of a capsule along y that hits a capsule along z at a distance `arm` from its centre.
Scene after_impact(double arm, double dt) {
  Touching t(exact(contact_scene({capsule({0, -0.5, arm}, {0, 0.5, arm}, {1, 0, 0}),
                                  capsule({2 * r, 0, -1}, {2 * r, 0, 1}, {0, 0, 0})})),
             dt);
  t.step();
  return t.scene;
}

TEST_CASE("an off-centre impact gives the impulse of rigid bodies, to first order in the step") {
  for (const double arm : {0.3, 0.8}) {
    const auto error = [&](double dt) {
      const Scene scene = after_impact(arm, dt);
      const Segment &one = scene.rods[0].segments[0], &other = scene.rods[1].segments[0];
      const double impulse = 1 / (1 / one.mass + 1 / other.mass + arm * arm / other.inertia_transverse);
      return (scene.rods[0].velocity[0] - Vector3(1 - impulse / one.mass, 0, 0)).norm() +
             (scene.rods[1].velocity[0] - Vector3(impulse / other.mass, 0, 0)).norm() +
             (scene.rods[1].angular_velocity[0] - Vector3(0, arm * impulse / other.inertia_transverse, 0)).norm();
    };
    CHECK(error(1e-3) < 2e-3);
    CHECK(error(5e-4) < 0.6 * error(1e-3));
  }
}

TEST_CASE("an impact keeps angular momentum to first order in the step, with friction too") {
  const auto lost = [](double dt) {
    Scene scene = contact_scene({capsule({0, -0.5, 0.4}, {0, 0.5, 0.3}, {1, 0.5, 0.4}),
                                 capsule({2.05 * r, 0.1, -1}, {2.05 * r, 0, 1}, {0, 0, 0})},
                                0.5);
    scene.rods[1].angular_velocity[0] = {0.3, 0.2, 0.5};
    Touching t(scene, dt);
    const Vector3 before = test::angular_momentum(t.scene), linear = test::linear_momentum(t.scene);
    t.run(static_cast<int>(std::lround(0.02 / dt)));
    CHECK((test::linear_momentum(t.scene) - linear).norm() < 1e-12 * linear.norm());
    CHECK((t.scene.rods[0].velocity[0] - Vector3(1, 0.5, 0.4)).norm() > 0.1);
    return (test::angular_momentum(t.scene) - before).norm() / before.norm();
  };
  CHECK(lost(1e-3) < 4e-3);
  CHECK(lost(5e-4) < 0.6 * lost(1e-3));
}

/// Capsules in a box of 1 m, all moving towards its middle.
Scene swarm(unsigned seed, double friction) {
  test::Random random(seed);
  std::vector<Rod> rods;
  while (rods.size() < 12) {
    const Vector3 at = random.vector(0.5), half = random.vector(0.15);
    rods.push_back(capsule(at - half, at + half, -4 * at));
    rods.back().angular_velocity[0] = random.vector(3);
    if (test::nearest(contact_scene(rods)) < 1) rods.pop_back();
  }
  return contact_scene(rods, friction);
}

TEST_CASE("collisions never give kinetic energy, and keep linear momentum to rounding") {
  for (const auto& [friction, restitution] : {std::pair(0.0, 0.0), {0.4, 0.0}, {0.0, 0.5}, {0.0, 1.0}, {0.4, 1.0}})
    for (const unsigned seed : {1u, 2u, 3u}) {
      Scene scene = swarm(seed, friction);
      scene.contact->restitution = restitution;
      const double dt = restitution < 1 ? 0.005 : 0.001;  // what spins on needs shorter steps
      Touching t(scene, dt);
      const Vector3 momentum = test::linear_momentum(t.scene);
      const double start = test::kinetic_energy(t.scene);
      double energy = start;
      while (t.scene.time_s < 0.4) {
        const StepReport report = t.step();
        CHECK(report.penetration < 0.01);
        const double now = test::kinetic_energy(t.scene);
        CHECK(now < energy + 1e-3 * start);  // the step integrates rotation to first order
        energy = now;
      }
      CHECK(energy < (restitution == 0 ? 0.5 : restitution < 1 ? 0.8 : 1) * start);
      CHECK((test::linear_momentum(t.scene) - momentum).norm() < 1e-11);
    }
}

/// Shoots a rod at another one, `radii` per step, at an angle between them; true if it hits and does not pass.
bool stays_before(double angle_deg, double radii, double offset, int segments) {
  const double dt = 0.01, angle = angle_deg * pi / 180;
  const Vector3 along(0, std::sin(angle), std::cos(angle));
  RodParameters p;
  p.youngs_modulus_pa = 1e6;
  Rod target = test::straight_rod({0, 0, -0.5}, {0, 0, 0.5}, segments, p);
  Rod bullet = test::straight_rod(Vector3(-7.3 * r, 0, offset) - along / 2, Vector3(-7.3 * r, 0, offset) + along / 2,
                                  segments, p);
  for (Vector3& v : bullet.velocity) v = {radii * r / dt, 0, 0};
  Touching t(contact_scene({bullet, target}, 0.2), dt);
  const auto crossed = [&t] {  // two long rods that cross near their middles have changed sides
    for (std::size_t a = 0; a < t.scene.rods[0].segments.size(); ++a)
      for (std::size_t b = 0; b < t.scene.rods[1].segments.size(); ++b) {
        const Rod &one = t.scene.rods[0], &other = t.scene.rods[1];
        const Vector3 between =
            separation({one.position[a], one.segments[a].length_m / 2 * director(one.orientation[a])},
                       {other.position[b], other.segments[b].length_m / 2 * director(other.orientation[b])});
        if (between.norm() < 3 * r && between.x() > 0.5 * between.norm()) return true;
      }
    return false;
  };
  const int flight = static_cast<int>(std::ceil(5.3 / radii));
  for (int i = 0; i < flight + 3; ++i) {  // few steps more: later they may turn about each other
    t.step();
    if (crossed()) return false;
  }
  return linear_momentum(t.scene.rods[1]).x() > 0;  // the target was hit
}

TEST_CASE("a rod shot at another at one radius per step, and faster, never passes through") {
  for (const int segments : {1, 8, 20})
    for (const double angle : {0.0, 1.0, 10.0, 30.0, 45.0, 90.0})
      for (const double radii : {1.0, 1.7, 9.0}) {
        if (segments > 1 && radii > 2) continue;  // such impacts tear soft rods
        INFO(segments << " segments at " << angle << " degrees, " << radii << " radii per step");
        CHECK(stays_before(angle, radii, 0.06, segments));
      }
}

TEST_CASE("a rod that is fed against a floor bends, and is not flung away") {
  CoilingRod p;
  p.segments = 40;
  p.length_m = 1;
  p.height_m = 0.02;
  p.radius_m = 0.01;
  p.youngs_modulus_pa = 1e6;
  p.torsion_modulus_pa = 1e5;
  p.contact = ContactSettings{};
  Touching t(build_scene(p), 0.005);
  for (int i = 0; i < 40; ++i) t.step();
  const Vector3 tip = t.scene.rods.front().position.back();
  CHECK(std::hypot(tip.x(), tip.z()) < 0.2);
}

TEST_CASE("rods that start inside each other part, slowly") {
  for (const double distance : {1.6, 0.02}) {
    Touching t(contact_scene({capsule({0, 0, -1}, {0, 0, 1}, {0, 0, 0}),
                              capsule({distance * r, 0, -1}, {distance * r, 0, 1}, {0, 0, 0})}),
               0.005);
    t.run(250);
    CHECK(test::nearest(t.scene) > 0.9999);
    for (const Rod& rod : t.scene.rods) CHECK(rod.velocity[0].norm() < 0.02 * r / 0.005);
  }
}

TEST_CASE("a scene in which nothing touches takes the same steps, bit for bit, with contact as without") {
  Scene with = test::moving_scene(12), without = with;
  with.contact = ContactSettings{};
  with.obstacles = {Ball{{5, 5, 5}, 1}, HalfSpace{{0, -9, 0}, {0, 1, 0}}};
  Touching a(with, 0.02), b(without, 0.02);
  CHECK(a.run(10) == 0);
  b.run(10);
  for (int s = 0; s < 12; ++s) {
    CHECK(a.scene.rods[0].position[s] == b.scene.rods[0].position[s]);
    CHECK(a.scene.rods[0].orientation[s].coeffs() == b.scene.rods[0].orientation[s].coeffs());
  }
}

TEST_CASE("contact settings and half-spaces that are none are refused") {
  const Scene good = contact_scene({capsule({0, 0, 0}, {0, 0, 1}, {0, 0, 0})});
  const std::pair<void (*)(Scene&), const char*> refused[] = {
      {[](Scene& s) { s.contact->friction = -0.1; }, "friction is -0.1; must be at least 0 and finite"},
      {[](Scene& s) { s.contact->obstacle_friction = -1; }, "obstacle_friction is -1; must be at least 0 and finite"},
      {[](Scene& s) { s.contact->recovery = 1.5; }, "recovery is 1.5; must be from 0 to 1"},
      {[](Scene& s) { s.contact->restitution = 2; }, "restitution is 2; must be from 0 to 1"},
      {[](Scene& s) { s.contact->tolerance = 0; }, "tolerance is 0; must be positive"},
      {[](Scene& s) {
         s.obstacles = {HalfSpace{{0, 0, 0}, {0, 0, 0}}};
       },
       "the normal must not be zero"}};
  for (const auto& [change, what] : refused) {
    Scene scene = good;
    change(scene);
    CHECK_THROWS_WITH(TimeStepper(scene, {}), Catch::Matchers::ContainsSubstring(what));
  }
}

}  // namespace rodsweep::test_contact
