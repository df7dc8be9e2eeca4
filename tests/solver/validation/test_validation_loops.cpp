// Closed rods: Michell's instability of a twisted ring; a net under its weight.
#include <cmath>

#include "solver/step/observables.hpp"
#include "tests/catch.hpp"
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
