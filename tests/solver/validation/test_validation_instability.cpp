// Slender cantilevers near the loads at which they lose stability: a deep one that its end load turns sideways, and one
// under an axial moment that keeps its direction. Steps in balance.
#include <cmath>

#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"

namespace rodsweep::test_validation_instability {

/// A cantilever of 1 m along x, whose bending stiffness sideways is 1 Nm^2. `upright`, `torsion`: relative to it.
BendingRod cantilever(int segments, double upright, double torsion) {
  BendingRod p = weightless_cantilever(segments, 1e9, 1e9, 1);
  p.section = GivenSection{1e-4, 1e-9, 1e-9 * upright, 1e-9 * torsion, 1};
  return p;
}

/// The turn of the tip, times P / H, of a narrow cantilever under an end load P upright and a small load H sideways; k =
/// P L^2 / sqrt(EI GJ). With x from the tip, EI w'' = H x + P x phi and GJ phi'' = -P x w'' give f'' + (k x)^2 f = 0 for
/// f = phi + H / P, f'(0) = 0, f(L) = H / P (Timoshenko & Gere 1961): a series in x^4, zero first at k = 4.0126.
double exact_turn(double k) {
  double term = 1, sum = 1;
  for (int n = 0; std::abs(term) > 1e-16; ++n) sum += term *= -k * k / ((4 * n + 4) * (4 * n + 3));
  return 1 / sum - 1;
}

TEST_CASE("A deep cantilever turns sideways under its end load as the theory of lateral-torsional buckling says") {
  CHECK(std::abs(1 / (1 + exact_turn(4.0126))) < 1e-5);
  const double sideways = 1e-5;
  for (const Integrator integrator : {Integrator::euler, Integrator::bdf2})
    for (const double k : {0.5 * 4.0126, 0.8 * 4.0126, 0.9 * 4.0126}) {
      BendingRod p = cantilever(40, 1000, 1);
      p.damping_per_s = 10;
      p.tip_force_n = {0, -k, sideways};
      Simulation simulation(build_scene(p), {0.02, 30, 1e-13, integrator}, 1e-8);
      simulation.run(300);
      const Quaternion& q = simulation.rod().orientation.back();
      const double turn = std::abs((q * Vector3::UnitY()).z());
      CAPTURE(k, turn * k / sideways, exact_turn(k));
      CHECK(turn * k / sideways == Approx(exact_turn(k)).epsilon(1.5e-2));
    }
}

/// The growth rate [1/s] of a cantilever's first mode as it circles under an axial moment at its tip.
double growth_rate(double moment_nm) {
  constexpr double dt = 2e-3;
  BendingRod p = cantilever(30, 1, 1e6);
  p.tip_torque_nm = {moment_nm, 0, 0};
  Scene scene = build_scene(p);
  constexpr double beta = 1.8751040687, ratio = 0.7340955, size = 1e-4;
  const double frequency = beta * beta * std::sqrt(1 / 0.1);  // EI / (rho A L^4)
  Rod& rod = scene.rods.front();
  for (std::size_t s = 1; s < rod.segments.size(); ++s) {  // behind the wall
    const double at = beta * rod.position[s].x();
    const double mode = size * (std::cosh(at) - std::cos(at) - ratio * (std::sinh(at) - std::sin(at)));
    const double slope = size * beta * (std::sinh(at) + std::sin(at) - ratio * (std::cosh(at) - std::cos(at)));
    rod.position[s].y() = mode;
    rod.orientation[s] = Quaternion(Eigen::AngleAxisd(slope, Vector3::UnitZ())) * rod.orientation[s];
    rod.velocity[s].z() = frequency * mode;
    rod.angular_velocity[s].y() = -frequency * slope;
  }
  Simulation simulation(scene, {dt, 30, 1e-13, Integrator::bdf2}, 1e-8);
  const int second = static_cast<int>(std::lround(1 / dt));
  const auto distance = [&] {
    double sum = 0;
    for (int step = 0; step < second; ++step) {
      simulation.step();
      sum += std::hypot(tip(simulation.rod()).y(), tip(simulation.rod()).z());
    }
    return sum;
  };
  const double early = distance();
  simulation.run(2 * second);
  return std::log(distance() / early) / 3;
}

TEST_CASE("A cantilever flutters under a dead axial moment as fast as it should") {
  // No moment is small enough (Nikolai 1928). To first order, from m w'' + EI w'''' + i M w''' = 0 with the work of M at
  // the tip: M f'(L)^2 / (4 omega m int f^2), where f'(L) = 1.3765 f(L) / L and f(L)^2 L = 4 int f^2.
  const double slope = 2 * 1.3765, frequency = 3.516015 * std::sqrt(1 / 0.1);
  for (const double moment : {-0.1, 0.1}) {
    const double expected = moment * slope * slope / (4 * frequency * 0.1);
    CHECK(growth_rate(moment) == Approx(expected).epsilon(3e-2));
  }
}

}  // namespace rodsweep::test_validation_instability
