// Twisted rods below their buckling twist, and a beam that is spun up: right in balance, known errors of the paper's step.
#include <algorithm>
#include <cmath>
#include <complex>

#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"

namespace rodsweep::test_validation_twist {

constexpr double greenhill = 8.98682;  // buckling moment of a clamped rod, times L / EI (Greenhill 1883)

/// |w| EI / (q L^4) in the middle of a rod clamped at both ends, under the axial moment m EI / L and a small load q
/// across: EI w'''' - i M w''' = q for w = y + i z. The solution is c0 + c1 x + c2 x^2 + c3 exp(i m x) + i x^3 / 6m.
double exact_sag(double m) {
  using Complex = std::complex<double>;
  constexpr Complex i(0, 1);
  const auto terms = [&](double x, bool slope) {
    const Complex e = std::exp(i * m * x);
    Eigen::Matrix<Complex, 1, 5> row;
    if (slope)
      row << 0, 1, 2 * x, i * m * e, i * x * x / (2 * m);
    else
      row << 1, x, x * x, e, i * x * x * x / (6 * m);
    return row;
  };
  Eigen::Matrix<Complex, 4, 5> ends;
  ends << terms(0, false), terms(0, true), terms(1, false), terms(1, true);
  const Eigen::Matrix<Complex, 4, 1> c = ends.leftCols<4>().partialPivLu().solve(-ends.col(4));
  const auto middle = terms(0.5, false);
  return std::abs((middle.head<4>() * c)(0) + middle(4));
}

/// The greatest sag in the last second of six, in the same units, of a rod that is twisted in the first two.
double sag(double part_of_greenhill, double dt, std::optional<double> momentum_tolerance,
           Integrator integrator = Integrator::euler) {
  BendingRod p = weightless_cantilever(120, 1e9, 5e8, 1, 0.005);  // EI = GJ
  p.gravity_m_s2 = {0, -0.02, 0};
  p.damping_per_s = 10;
  p.stretch = Stretch::physical;
  p.tip_motion = TipMotion{{0, 0, 0}, {part_of_greenhill * greenhill * 180 / pi, 0, 0}, 2};
  Simulation simulation(build_scene(p), {dt, 30, 1e-13, integrator}, momentum_tolerance);
  const int steps = static_cast<int>(std::lround(6 / dt)), last_second = static_cast<int>(std::lround(5 / dt));
  double most = 0;
  for (int step = 0; step < steps; ++step) {
    simulation.step();
    // Behind the wall's static segment, 60 segments end at the middle.
    const Vector3 middle = (simulation.rod().position[60] + simulation.rod().position[61]) / 2;
    if (step >= last_second) most = std::max(most, std::hypot(middle.y(), middle.z()));
  }
  return most * p.youngs_modulus_pa * p.radius_m * p.radius_m / 4 / (p.density_kg_m3 * 0.02);  // EI / q, L = 1
}

TEST_CASE("A rod twisted below its buckling twist sags as the theory of Greenhill's rod says, in balance") {
  CHECK(exact_sag(0.5 * greenhill) == Approx(0.003179).epsilon(2e-4));
  CHECK(exact_sag(0.9 * greenhill) == Approx(0.009598).epsilon(2e-4));
  for (const Integrator integrator : {Integrator::euler, Integrator::bdf2})
    for (const double part : {0.5, 0.9, 0.95})
      CHECK(sag(part, 0.02, 1e-8, integrator) == Approx(exact_sag(part * greenhill)).epsilon(6e-3));
}

TEST_CASE("A rod twisted below its buckling twist whirls in the paper's step, a known error") {
  const auto error = [](double part, double dt, Integrator integrator = Integrator::euler) {
    return sag(part, dt, {}, integrator) / exact_sag(part * greenhill);
  };
  CHECK(error(0.5, 0.02) == Approx(1).epsilon(3e-3));
  CHECK(error(0.8, 0.02) > 15);
  CHECK(error(0.9, 0.02) > 9);
  CHECK(error(0.95, 0.005) > 2);
  CHECK(error(0.95, 0.002) == Approx(1).epsilon(3e-3));
  CHECK(error(0.5, 0.02, Integrator::bdf2) > 10);
}

/// A beam along x that is spun up about z to 6 rad/s in 15 s (Kane, Ryan & Banerjee 1987; numbers of Simo & Vu-Quoc
/// 1986): the greatest lag of its tip behind the rotating axis until then, and its mean extension in the two seconds after.
struct SpunUp {
  double lag_m = 0, extension_m = 0;
};
SpunUp spun_up(Integrator integrator, double dt, std::optional<double> momentum_tolerance) {
  BendingRod p = weightless_cantilever(40, 2.8e10, 1e10, 10);
  p.section = GivenSection{1e-3, 5e-7, 5e-7, 1e-6, 1};
  p.density_kg_m3 = 1200;
  p.stretch = Stretch::physical;
  Scene scene = build_scene(p);
  const auto angle = [](double t) {
    if (t >= 15) return 6 * t - 45;
    const double rate = 2 * pi / 15;
    return 0.4 * (t * t / 2 + (std::cos(rate * t) - 1) / (rate * rate));
  };
  scene.clamps.push_back(
      {0, 0, [=, from = scene.rods[0].orientation[0]](double t) {
         return Pose{Vector3::Zero(), Quaternion(Eigen::AngleAxisd(angle(t), Vector3::UnitZ())) * from};
       }});
  Simulation simulation(scene, {dt, 30, 1e-10, integrator}, momentum_tolerance);
  SpunUp out;
  const int spinning_up = static_cast<int>(std::lround(15 / dt)), after = static_cast<int>(std::lround(2 / dt));
  for (int step = 1; step <= spinning_up + after; ++step) {
    simulation.step();
    const double turned = angle(step * dt);
    const Vector3 axis(std::cos(turned), std::sin(turned), 0), across(-axis.y(), axis.x(), 0),
        end = tip(simulation.rod());
    if (step <= spinning_up)
      out.lag_m = std::max(out.lag_m, -end.dot(across));
    else
      out.extension_m += (end.dot(axis) - p.length_m) / after;
  }
  return out;
}

TEST_CASE(
    "A beam that is spun up lags behind and stretches as it should by BDF2, lags at 0.01 s twice as far by Euler") {
  for (const std::optional<double> balance : {std::optional<double>(), std::optional<double>(1e-6)}) {
    const SpunUp right = spun_up(Integrator::bdf2, 0.01, balance);
    CHECK(right.lag_m == Approx(0.574).epsilon(5e-3));
    CHECK(right.extension_m == Approx(1200 * 36 * 1000 / (3 * 2.8e10)).epsilon(2e-3));  // rho w^2 L^3 / 3 E
    CHECK(spun_up(Integrator::euler, 0.01, balance).lag_m > 1.1);
    CHECK(spun_up(Integrator::euler, 0.0025, balance).lag_m < 0.63);
  }
}

}  // namespace rodsweep::test_validation_twist
