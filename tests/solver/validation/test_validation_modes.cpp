// Small vibrations: frequency and decay of the modes of a clamped-free beam, in bending and torsion, and of a hanging
// rope.
//
// Initial velocities start a mode; its own shape projects the motion (oscillation.hpp has the effect of implicit Euler
// on frequency and amplitude).
#include <cmath>
#include <complex>

#include "tests/catch.hpp"
#include "tests/solver/oscillation.hpp"
#include "tests/solver/simulation.hpp"

namespace rodsweep::test_validation_modes {

/// Gives a straight wall-clamped rod the transverse velocities `at_vertices` along `direction`; segments move rigidly.
void set_transverse_velocity(Rod& rod, const VectorX& at_vertices, const Vector3& direction) {
  for (std::size_t s = 1; s < rod.segments.size(); ++s) {
    const double before = at_vertices[static_cast<Eigen::Index>(s) - 1],
                 after = at_vertices[static_cast<Eigen::Index>(s)];
    rod.velocity[s] = (before + after) / 2 * direction;
    rod.angular_velocity[s] =
        (after - before) / rod.segments[s].length_m * director(rod.orientation[s]).cross(direction);
  }
}

/// The factor per step of a mode over `cycles` periods of about `frequency`, from a small start in its shape.
std::complex<double> mode_factor(Scene scene, const VectorX& shape, const Vector3& direction, double frequency,
                                 double dt, double cycles, Integrator integrator = Integrator::euler) {
  const double amplitude = 1e-5;  // of the displacement [m]; small enough for linearity to 1e-9
  Rod& start = scene.rods.front();
  set_transverse_velocity(start, amplitude * frequency / shape.lpNorm<Eigen::Infinity>() * shape, direction);
  const double period = 2 * pi / (frequency * dt);  // in steps
  return factor_per_step(std::move(scene), dt, static_cast<int>(cycles * period),
                         static_cast<std::size_t>(std::max(1.0, period / 5)), integrator);
}

/// Clamped-free Euler-Bernoulli mode k at the vertices, and beta L.
constexpr double beta_length[] = {1.875104, 4.694091, 7.854757};

VectorX beam_mode(int k, int segments) {
  const double b = beta_length[k];
  const double sigma = (std::cosh(b) + std::cos(b)) / (std::sinh(b) + std::sin(b));
  VectorX shape(segments + 1);
  for (int i = 0; i <= segments; ++i) {
    const double x = b * i / segments;
    shape[i] = std::cosh(x) - std::cos(x) - sigma * (std::sinh(x) - std::sin(x));
  }
  return shape;
}

double beam_frequency(const BendingRod& p, int k) {
  const double second_moment = pi * std::pow(p.radius_m, 4) / 4, area = pi * p.radius_m * p.radius_m;
  return std::pow(beta_length[k] / p.length_m, 2) *
         std::sqrt(p.youngs_modulus_pa * second_moment / (p.density_kg_m3 * area));
}

struct Modes {
  VectorX frequency;      ///< [rad/s], ascending
  Eigen::MatrixXd shape;  ///< deflections at the vertices, one mode per column
};

/// Plane modes of a chain of N rigid cylinders on a wall, with EI/l in its joints and 2 EI/l at the wall. Unknowns are
/// the segments' angles, so joints hold exactly.
Modes chain_modes(const BendingRod& p) {
  const int n = p.segments;
  const double l = p.length_m / n, area = pi * p.radius_m * p.radius_m, mass = p.density_kg_m3 * area * l;
  const double inertia = mass * (3 * p.radius_m * p.radius_m + l * l) / 12;
  const double joint = p.youngs_modulus_pa * pi * std::pow(p.radius_m, 4) / 4 / l;
  Eigen::MatrixXd vertices = Eigen::MatrixXd::Zero(n + 1, n), stiffness = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) vertices.row(i + 1) = vertices.row(i) + l * Eigen::MatrixXd::Identity(n, n).row(i);
  const Eigen::MatrixXd centres = (vertices.topRows(n) + vertices.bottomRows(n)) / 2;
  const Eigen::MatrixXd masses =
      mass * test::product(centres.transpose(), centres) + inertia * Eigen::MatrixXd::Identity(n, n);
  stiffness(0, 0) = 2 * joint;
  for (int i = 1; i < n; ++i) {
    stiffness(i - 1, i - 1) += joint;
    stiffness(i, i) += joint;
    stiffness(i - 1, i) = stiffness(i, i - 1) = -joint;
  }
  const test::Modes modes = test::modes(stiffness, masses);
  return {modes.values.cwiseSqrt(), test::product(vertices, modes.vectors)};
}

TEST_CASE("A clamped-free beam vibrates at Euler and Bernoulli's first frequency") {
  const int n = GENERATE(50, 100);
  const double dt = 5e-4;
  const BendingRod p = weightless_cantilever(n, 1e9, 1e9);
  const double w = beam_frequency(p, 0);
  CHECK(w / (2 * pi) == Approx(3.49745).epsilon(1e-5));
  const std::complex<double> z = mode_factor(build_scene(p), beam_mode(0, n), Vector3::UnitY(), w, dt, 1);
  CHECK(std::arg(z) / dt == Approx(std::atan(w * dt) / dt).epsilon(1e-3));
}

TEST_CASE("The modes of a clamped-free chain have the frequencies and the decay of its discrete eigenproblem") {
  const int k = GENERATE(0, 1, 2);
  const double dt = GENERATE(5e-4, 2e-3);
  const BendingRod p = weightless_cantilever(50, 1e9, 1e9);
  const Modes modes = chain_modes(p);
  const double w = modes.frequency[k];
  const std::complex<double> z = mode_factor(build_scene(p), modes.shape.col(k), Vector3::UnitZ(), w, dt, 1);
  CHECK(std::arg(z) / dt == Approx(std::atan(w * dt) / dt).epsilon(1e-4));
  CHECK(-std::log(std::abs(z)) == Approx(std::log1p(w * w * dt * dt) / 2).epsilon(1e-4));
}

// The backward difference of z^k is u z^k with u = (1 - 1 / z) / dt, with BDF2 (3 - 4 / z + 1 / z^2) / (2 dt). So u^2 +
// tau w^2 u + w^2 = 0 for any step.
TEST_CASE("Internal damping lets the modes of a chain decay by half of tau times their squared frequency") {
  const int k = GENERATE(0, 1, 2);
  const Integrator integrator = GENERATE(Integrator::euler, Integrator::bdf2);
  const double dt = 5e-4, tau = 5e-4;
  BendingRod p = weightless_cantilever(50, 1e9, 1e9);
  p.internal_damping_s = tau;
  const Modes modes = chain_modes(p);
  const double w = modes.frequency[k];
  const std::complex<double> z =
      mode_factor(build_scene(p), modes.shape.col(k), Vector3::UnitZ(), w, dt, 1, integrator);
  const std::complex<double> u =
      integrator == Integrator::euler ? (1.0 - 1.0 / z) / dt : (3.0 - 4.0 / z + 1.0 / (z * z)) / (2 * dt);
  CHECK(-u.real() == Approx(w * w * tau / 2).epsilon(2e-3));
  CHECK(std::abs(u) == Approx(w).epsilon(1e-4));
}

TEST_CASE("A finely divided beam has the first frequency that rotary inertia gives it", "[.long]") {
  const double dt = 5e-4;
  const auto frequency = [&](int n) {
    const BendingRod p = weightless_cantilever(n, 1e9, 1e9);
    const double w = beam_frequency(p, 0);
    return std::tan(std::arg(mode_factor(build_scene(p), beam_mode(0, n), Vector3::UnitY(), w, dt, 2))) / dt / w;
  };
  const double limit = (4 * frequency(200) - frequency(100)) / 3;  // without the error in 1/N^2
  // Rayleigh's correction: -(1/2) (I / A) times int phi'^2 / int phi^2, which is 4.6478 / L^2 for mode 1.
  const BendingRod p = weightless_cantilever(200, 1e9, 1e9);
  CHECK(limit == Approx(1 - 4.6478 / 2 * std::pow(p.radius_m / (2 * p.length_m), 2)).epsilon(5e-6));
}

/// The factor per step of the first torsional mode of a clamped-free round rod by BDF2.
std::complex<double> torsional_factor(const BendingRod& p, double frequency, double dt) {
  Scene scene = build_scene(p);
  Rod& start = scene.rods.front();
  const Quaternion straight = start.orientation.front();
  std::vector<double> shape;
  for (std::size_t s = 0; s < start.segments.size(); ++s) {
    shape.push_back(std::sin(pi * start.position[s].x() / (2 * p.length_m)));
    start.angular_velocity[s].x() = 1e-4 * frequency * shape.back();
  }
  Simulation simulation(scene, StepSettings{dt, 12, 1e-14, Integrator::bdf2});
  const double period = 2 * pi / (frequency * dt);  // in steps
  simulation.run(20);                               // the first step is Euler's; BDF2's second root decays
  std::vector<double> samples;
  for (int step = 0; step < static_cast<int>(2 * period); ++step) {
    simulation.step();
    double sum = 0;
    for (std::size_t s = 0; s < shape.size(); ++s)
      sum += shape[s] * rotation(simulation.rod().orientation[s], straight).x();
    samples.push_back(sum);
  }
  return factor_per_step(samples, static_cast<std::size_t>(period / 5));
}

TEST_CASE("A clamped-free rod vibrates in torsion with the period 4 L sqrt(rho / G), with errors of second order") {
  const BendingRod p = weightless_cantilever(40, 1e7, 4e6);
  const double speed = std::sqrt(p.torsion_modulus_pa / p.density_kg_m3), w = pi / 2 * speed / p.length_m;
  CHECK(w / (2 * pi) == Approx(7.90569).epsilon(1e-6));
  // A chain of N equal inertias: its frequency is w sin(a) / a with a = pi / 4N.
  const double a = pi / (4 * p.segments), of_chain = w * std::sin(a) / a;
  double error[2];
  for (int k = 0; k < 2; ++k) {
    const double dt = 2 * pi / w / (100 << k);
    const std::complex<double> z = torsional_factor(p, w, dt), step(0, of_chain * dt);
    const std::complex<double> expected = (2.0 + std::sqrt(1.0 + 2.0 * step)) / (3.0 - 2.0 * step);  // of BDF2
    CHECK(std::abs(z - expected) < 1e-8);
    CHECK(std::arg(z) / dt == Approx(w).epsilon(k == 0 ? 1.5e-3 : 5e-4));
    error[k] = std::arg(z) / (of_chain * dt) - 1;
  }
  CHECK(std::log2(error[0] / error[1]) == Approx(2).margin(0.05));
}

TEST_CASE("A rod without bending stiffness swings as a hanging rope") {
  struct Case {
    double frequency, bessel_root;
  };
  const Case c = GENERATE(Case{1.202413, 2.404826}, Case{2.760039, 5.520078});
  const int n = 50;
  BendingRod p;
  p.segments = n;
  p.clamp = Clamp::wall;
  p.radius_m = 0.01;
  p.initial_angle_deg = -90;
  p.youngs_modulus_pa = p.torsion_modulus_pa = 1;  // EI / w L^3 = 2.5e-10
  const double w = c.frequency * std::sqrt(9.81 / p.length_m);
  VectorX shape(n + 1);  // J0(j0k sqrt(s / L)), s from the free end
  for (int i = 0; i <= n; ++i)
    shape[i] = std::cyl_bessel_j(0, c.bessel_root * std::sqrt(1 - static_cast<double>(i) / n));
  const double dt = 1e-3;
  const std::complex<double> z = mode_factor(build_scene(p), shape, Vector3::UnitX(), w, dt, 1);
  CHECK(std::arg(z) / dt == Approx(w).epsilon(5e-3));
}

}  // namespace rodsweep::test_validation_modes
