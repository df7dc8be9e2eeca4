// Rods at rest under their weight and under loads, against closed forms and quadratures. Relaxation (simulation.hpp)
// reaches rest unless a test says otherwise. E = Young's modulus, w = rho A g.
#include <cmath>

#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"

namespace rodsweep::test_validation_statics {

constexpr double gravity = 9.81;

double second_moment(double radius) { return pi * std::pow(radius, 4) / 4; }

BendingRod cantilever(int segments, double youngs_modulus, Clamp clamp = Clamp::wall) {
  BendingRod p;  // 2 m, r = 0.05 m, 1000 kg/m^3
  p.segments = segments;
  p.youngs_modulus_pa = p.torsion_modulus_pa = youngs_modulus;
  p.clamp = clamp;
  return p;
}

double weight_per_length(const BendingRod& p) {
  return p.density_kg_m3 * pi * p.radius_m * p.radius_m * p.gravity_m_s2.norm();
}

/// Deflection and axial position of the tip of a heavy wall-clamped rod with gamma = w L^3 / EI, over L.
Vector3 heavy_elastica(double gamma, int segments, double dt = 0.3, double damping = 0) {
  BendingRod p;
  p = cantilever(segments, weight_per_length(p) * std::pow(p.length_m, 3) / (gamma * second_moment(p.radius_m)));
  p.damping_per_s = damping;
  Simulation simulation(build_scene(p), dt);
  simulation.relax();
  return tip(simulation.rod()) / p.length_m;
}

/// Drop of the free end of a hanging helix over Castigliano's value at the same weight.
double helix_drop(int segments, double g) {
  Helix p;
  p.segments = segments;
  p.clamp = Clamp::wall;
  p.youngs_modulus_pa = p.torsion_modulus_pa = 1e10;
  p.gravity_m_s2 = Vector3(0, -g, 0);
  Scene scene = build_scene(p);
  const double before = tip(scene.rods.front()).y();
  Simulation simulation(std::move(scene), 1);
  simulation.relax();
  return (before - tip(simulation.rod()).y()) / (0.00629735 * g / gravity);
}

TEST_CASE("A stiff cantilever sags as the discrete law of its clamp says") {
  const Clamp clamp = GENERATE(Clamp::wall, Clamp::segment);
  const double n = GENERATE(10, 50);
  BendingRod p = cantilever(static_cast<int>(n), 1e9, clamp);
  const double law = clamp == Clamp::wall ? 1 + 1 / (n * n) : (1 - 1 / n) * (1 - 1 / n);
  const auto sag_over_law = [&] {
    Simulation simulation(build_scene(p), 1);
    simulation.relax();
    const double euler = weight_per_length(p) * std::pow(p.length_m, 4) / (8 * 1e9 * second_moment(p.radius_m));
    return -tip(simulation.rod()).y() / (euler * law);
  };
  CHECK(sag_over_law() == Approx(1).epsilon(5e-4));
  p.gravity_m_s2 /= 30;  // the rest is not geometry: shear in the "inextensible" rows, 3e-6
  CHECK(sag_over_law() == Approx(1).epsilon(1e-5));
}

TEST_CASE("A heavy rod takes the shape of the elastica, with an error of second order in 1/N") {
  struct Case {
    double gamma, y, x;
  };
  const Case c = GENERATE(Case{1, 0.123471, 0.991246}, Case{2, 0.238507, 0.966893}, Case{10, 0.700200, 0.656354});
  const Vector3 end = heavy_elastica(c.gamma, 50);
  CHECK(-end.y() == Approx(c.y).epsilon(1e-3));
  CHECK(end.x() == Approx(c.x).epsilon(1e-3));
  CHECK(std::abs(end.z()) < 1e-12);
  CHECK(order(-heavy_elastica(c.gamma, 30).y() - c.y, -heavy_elastica(c.gamma, 60).y() - c.y) ==
        Approx(2).margin(0.05));
}

TEST_CASE("A rod at rest under its weight knows neither the time step nor the drag") {
  const Vector3 reference = heavy_elastica(2, 20);
  const double dt = GENERATE(0.1, 0.5), drag = GENERATE(0.0, 3.0);
  CHECK((heavy_elastica(2, 20, dt, drag) - reference).norm() < 1e-8);
}

TEST_CASE("A dropped rod with drag comes to rest in the shape of the elastica") {
  BendingRod p;
  p = cantilever(50, weight_per_length(p) * std::pow(p.length_m, 3) / (10 * second_moment(p.radius_m)));
  p.damping_per_s = 2;
  Simulation simulation(build_scene(p), 0.02);
  simulation.run(1000);
  CHECK((tip(simulation.rod()) / p.length_m - heavy_elastica(10, 50)).norm() < 1e-6);
}

TEST_CASE("A rod under an end moment bends by the same angle in every joint, whose sine is M l / EI") {
  const double dt = 2e-3;
  BendingRod p = cantilever(20, 1e6);
  p.radius_m = 0.2;  // of great inertia, so that the torque turns the last segment little in the prediction
  p.gravity_m_s2.setZero();
  p.damping_per_s = 5;
  const double l = p.length_m / p.segments, stiffness = p.youngs_modulus_pa * second_moment(p.radius_m);
  const double moment = 0.1 * stiffness / l;
  Scene scene = build_scene(p);
  scene.loads.push_back({0, p.segments, Vector3::Zero(), Vector3(0, 0, moment), Vector3::Zero()});
  Simulation simulation(std::move(scene), dt);
  simulation.run(4000);
  double heading = std::asin(moment * l / (2 * stiffness));  // the wall's joint has half the length
  for (std::size_t s = 1; s < simulation.rod().segments.size(); ++s) {
    const Vector3 along = director(simulation.rod().orientation[s]);
    CHECK(std::atan2(along.y(), along.x()) == Approx(heading).epsilon(1e-3));
    heading += std::asin(moment * l / stiffness);
  }
}

TEST_CASE("A hanging helix drops by Castigliano's value, with an error of second order in 1/N") {
  CHECK(helix_drop(120, gravity) == Approx(1).epsilon(5e-3));
  const double small = 0.01 * gravity;  // Castigliano's value is the limit of small drops
  CHECK(order(helix_drop(60, small) - 1, helix_drop(120, small) - 1) == Approx(2).margin(0.1));
}

TEST_CASE("A finely divided hanging helix drops by Castigliano's value", "[.long]") {
  CHECK(helix_drop(480, 0.01 * gravity) == Approx(1).epsilon(3e-5));
}

}  // namespace rodsweep::test_validation_statics
