// Closed rods: Michell's instability of a twisted ring; rings and nets under their weight.
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "solver/rod/linearization.hpp"
#include "solver/step/observables.hpp"
#include "tests/solver/simulation.hpp"

namespace rodsweep::test_validation_loops {

constexpr double michell_deg = 360 * 1.7320508075688772;  // total twist of 2 pi sqrt(3), for EI = GJ

/// A free, weightless, naturally straight ring with EI = GJ.
Ring isotropic_ring(int segments, double twist_deg) {
  Ring p;
  p.segments = segments;
  p.length_m = 2 * pi;
  p.radius_m = 0.05;
  p.clamp = Clamp::free;
  p.youngs_modulus_pa = 1e7;
  p.torsion_modulus_pa = 5e6;
  p.gravity_m_s2.setZero();
  p.twist_deg = twist_deg;
  return p;
}

double out_of_plane(const Rod& rod) {
  double square = 0;
  for (const Vector3& x : rod.position) square += x.z() * x.z();
  return std::sqrt(square / static_cast<double>(rod.position.size()));
}

/// The ring displaced out of its plane by `amplitude` cos 2 theta, the first unstable mode.
Scene disturbed_ring(int segments, double twist_deg, double amplitude) {
  Scene scene = build_scene(isotropic_ring(segments, twist_deg));
  Rod& rod = scene.rods.front();
  for (int s = 0; s < segments; ++s) rod.position[s].z() = amplitude * std::cos(4 * pi * s / segments);
  return scene;
}

/// dt^2 k / m of that mode is about 0.1. Newton ignores how forces turn with the rod, which matters at larger steps.
constexpr double overdamped_step = 0.05;

/// Growth rate of a small disturbance in overdamped steps of dt: each step multiplies a mode of stiffness k and mass m
/// by 1 / (1 + dt^2 k / m); this is -dt^2 k / m. It is zero where the planar ring becomes unstable.
double growth(int segments, double twist_deg) {
  Simulation simulation(disturbed_ring(segments, twist_deg, 1e-5), overdamped_step);
  for (int i = 0; i < 100; ++i) simulation.relax_once();  // until other modes have decayed
  const double before = out_of_plane(simulation.rod());
  for (int i = 0; i < 20; ++i) simulation.relax_once();
  return 1 - std::pow(before / out_of_plane(simulation.rod()), 1.0 / 20);
}

/// The twist at which growth() is zero over Michell's, by a secant between both sides.
double critical_twist(int segments) {
  double low = 0.97, high = 1.03, at_low = growth(segments, low * michell_deg),
         at_high = growth(segments, high * michell_deg);
  REQUIRE(at_low < 0);
  REQUIRE(at_high > 0);
  for (int i = 0; i < 3; ++i) {
    const double next = low - at_low * (high - low) / (at_high - at_low),
                 at_next = growth(segments, next * michell_deg);
    (at_next < 0 ? low : high) = next;
    (at_next < 0 ? at_low : at_high) = at_next;
  }
  return low - at_low * (high - low) / (at_high - at_low);
}

/// Force of the joints on the static segments.
Vector3 force_on_held(const Rod& rod, double constraint_dt) {
  Vector3 total = Vector3::Zero();
  for (std::size_t k = 0; k < rod.joints.size(); ++k) {
    const Joint& joint = rod.joints[k];
    const Vector3 multiplier = rod.lambda.segment<3>(static_cast<Eigen::Index>(6 * k));
    const Vector3 force = to_world(rod, joint, multiplier) / joint.length;
    if (rod.segments[joint.a].is_static) total += force;
    if (rod.segments[joint.b].is_static) total -= force;
  }
  return total / (constraint_dt * constraint_dt);
}

double potential_energy(const Scene& scene) {
  return gravitational_energy(scene.rods.front(), scene.gravity_m_s2) + elastic_energy(scene.rods.front());
}

/// Its rods can stretch: taut inextensible rods pull so hard that only steps of a millisecond come to rest.
Net small_net() {
  Net p;
  p.rows = p.columns = 5;
  p.youngs_modulus_pa = p.torsion_modulus_pa = 1e8;
  p.radius_m = 0.02;
  p.stretch = Stretch::physical;
  return p;
}

constexpr double settling_step = 0.01;

/// The scene at rest, after strong drag.
std::unique_ptr<Simulation> settle(Scene scene) {
  scene.damping_per_s = 25;
  auto simulation = std::make_unique<Simulation>(std::move(scene), settling_step);
  double moving = 1;
  for (int i = 0; i < 60 && moving > 1e-16; ++i) {
    simulation->run(50);
    moving = kinetic_energy(simulation->rod());
  }
  REQUIRE(moving <= 1e-16);
  return simulation;
}

Vector3 free_weight(const Scene& scene) {
  double mass = 0;
  for (const Segment& s : scene.rods.front().segments)
    if (!s.is_static) mass += s.mass;
  return mass * scene.gravity_m_s2;
}

TEST_CASE("A twisted ring stays planar below Michell's twist of 2 pi sqrt 3 and writhes above it") {
  Simulation below(disturbed_ring(40, 0.9 * michell_deg, 1e-3), overdamped_step);
  for (int i = 0; i < 600; ++i) below.relax_once();
  CHECK(out_of_plane(below.rod()) < 1e-5);

  Simulation above(disturbed_ring(40, 1.1 * michell_deg, 1e-3), overdamped_step);
  for (int i = 0; i < 500; ++i) above.relax_once();  // later the ring passes through itself and loses two turns
  CHECK(out_of_plane(above.rod()) > 0.1);            // the ring's radius is 1
  CHECK(joint_gap(above.rod()) < 1e-5);
}

TEST_CASE("Michell's twist is reached with an error of second order in 1/N", "[.long]") {
  const double coarse = critical_twist(24) - 1, fine = critical_twist(48) - 1;
  CAPTURE(coarse, fine);
  CHECK(std::abs(fine) < 4e-3);
  CHECK(std::log2(coarse / fine) == Approx(2).margin(0.15));
}

TEST_CASE("A naturally circular ring without load keeps its shape to the bit's order") {
  Ring p = isotropic_ring(30, 0);
  p.rest_shape = Ring::RestShape::circle;
  p.clamp = Clamp::segment;
  Scene scene = build_scene(p);
  const Rod start = scene.rods.front();
  Simulation simulation(std::move(scene), 0.02);
  simulation.run(200);
  for (std::size_t s = 0; s < start.position.size(); ++s)
    CHECK((simulation.rod().position[s] - start.position[s]).norm() < 1e-12);
}

TEST_CASE("A straight rod bent into a ring is in equilibrium, wherever it is cut") {
  Ring p = isotropic_ring(30, 0);
  Simulation simulation(build_scene(p), 0.5);
  CHECK(simulation.relax_once() < 1e-9);
  // Each joint is bent by theta: elastic energy N (EI / l) (2 sin(theta / 2))^2 / 2, close to EI / (2 R^2) 2 pi R.
  const double stiffness = 1e7 * pi * std::pow(0.05, 4) / 4, turn = 2 * pi / 30;
  CHECK(elastic_energy(simulation.rod()) ==
        Approx(30 * stiffness / turn * std::pow(2 * std::sin(turn / 2), 2) / 2).epsilon(1e-9));
}

TEST_CASE("A hanging ring and hanging nets settle, and what holds them carries their weight") {
  Ring ring;
  ring.segments = 24;
  ring.youngs_modulus_pa = ring.torsion_modulus_pa = 1e6;
  ring.rest_shape = Ring::RestShape::circle;
  Net side = small_net();
  side.held = Held::side;
  for (const SceneSpec& spec : {SceneSpec(ring), SceneSpec(small_net()), SceneSpec(side)}) {
    Scene scene = build_scene(spec);
    const double before = potential_energy(scene);
    const std::unique_ptr<Simulation> settled = settle(scene);
    const Rod& rod = settled->rod();
    const Vector3 weight = free_weight(scene);
    CHECK((force_on_held(rod, constraint_dt(settled->scene, settling_step)) - weight).norm() < 1e-5 * weight.norm());
    const double energy = potential_energy(settled->scene);
    CHECK(energy < before);
    CHECK(joint_gap(rod) < 1e-3);
    // A local minimum of the energy: a disturbance adds energy and decays.
    Scene disturbed = settled->scene;
    for (std::size_t s = 0; s < rod.position.size(); ++s)
      if (!rod.segments[s].is_static)
        disturbed.rods.front().velocity[s].z() = 0.2 * std::sin(3.0 * static_cast<double>(s));
    CHECK(potential_energy(settle(disturbed)->scene) == Approx(energy).epsilon(1e-7));
  }
}

TEST_CASE("A net held at its corners sags symmetrically") {
  const std::unique_ptr<Simulation> settled = settle(build_scene(small_net()));
  const Rod flat = build_scene(small_net()).rods.front();
  const auto height = [&](int row, int column) {
    const Vector3 at = small_net().mesh_m * Vector3(column, 0, row);
    int crossing = 0;
    while ((flat.position[crossing] - at).norm() > 1e-9) ++crossing;
    return settled->rod().position[crossing].y();
  };
  CHECK(height(2, 2) < -1e-3);
  for (int r = 0; r < 5; ++r)
    for (int c = 0; c < 5; ++c) {
      CHECK(height(r, c) == Approx(height(4 - r, c)).epsilon(1e-3).margin(1e-9));
      CHECK(height(r, c) == Approx(height(r, 4 - c)).epsilon(1e-3).margin(1e-9));
    }
}

/// Sag at the middle of the sides of a net of four rods held at its corners, over that of a clamped beam.
double corner_held_sag(int segments) {
  Net p;
  p.rows = p.columns = 2;
  p.segments = segments;
  p.mesh_m = 2;
  p.youngs_modulus_pa = p.torsion_modulus_pa = 1e9;
  p.gravity_m_s2 /= 300;
  Scene scene = build_scene(p);
  const Rod flat = scene.rods.front();
  Simulation simulation(std::move(scene), 1);
  simulation.relax();
  const double area = pi * p.radius_m * p.radius_m, second_moment = area * p.radius_m * p.radius_m / 4;
  const double beam = p.density_kg_m3 * area * p.gravity_m_s2.norm() * std::pow(p.mesh_m, 4) /
                      (384 * p.youngs_modulus_pa * second_moment);
  double sag = 0;
  int sides = 0;
  for (std::size_t s = 0; s < flat.position.size(); ++s) {
    const Vector3& at = flat.position[s];
    if (std::abs(at.x() - 1) > 1e-9 && std::abs(at.z() - 1) > 1e-9) continue;
    const double here = -simulation.rod().position[s].y();
    CHECK((sides == 0 || here == Approx(sag).epsilon(1e-6)));
    sag = here;
    ++sides;
  }
  REQUIRE(sides == 4);
  return sag / beam;
}

TEST_CASE("The sides of a net held at its corners sag as clamped beams, with an error of second order") {
  const double coarse = corner_held_sag(20) - 1, fine = corner_held_sag(40) - 1;
  CAPTURE(coarse, fine);
  CHECK(std::abs(fine) < 4e-3);
  CHECK(std::log2(coarse / fine) == Approx(2).margin(0.15));
}

}  // namespace rodsweep::test_validation_loops
