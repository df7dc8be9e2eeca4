// XPBD against Newton with direct solves: convergence, and the order in the step at which they agree.
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "solver/step/gauss_seidel.hpp"
#include "solver/step/observables.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/stepping.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_xpbd {

/// A rod of six segments after a smooth fall of 0.1 s.
Scene falling(double modulus_pa, std::optional<double> stretch_compliance_per_j = std::nullopt) {
  BendingRod spec = test::bending_rod(6);
  spec.youngs_modulus_pa = spec.torsion_modulus_pa = modulus_pa;
  spec.stretch_compliance_per_j = stretch_compliance_per_j;
  Simulation simulation(build_scene(spec), 1e-3, 20);
  simulation.run(100);
  return simulation.scene;
}

/// Orders in the step of the distance of one XPBD step from Newton's, for three halvings of `longest_s`.
std::vector<double> orders(const Scene& start, std::vector<Vector3> Rod::*of, double longest_s, int iterations) {
  std::vector<double> found;
  double before = 0;
  for (int halvings = 0; halvings < 4; ++halvings) {
    const double dt = longest_s / (1 << halvings);
    const double apart =
        test::distance(test::after<XpbdProjection>(start, dt, iterations), test::after_newton(start, dt), of);
    if (halvings > 0) found.push_back(std::log2(before / apart));
    before = apart;
  }
  return found;
}

TEST_CASE("the residual falls in every XPBD iteration, to rounding") {
  Scene scene = test::moving_scene(10);
  XpbdProjection xpbd(scene);
  test::Recorder recorder(xpbd);
  TimeStepper(scene, {0.02, 2000, 0}).step(recorder);
  const std::vector<double> residual = recorder.residuals();
  REQUIRE(residual.front() > 0.1);
  for (std::size_t i = 0; i + 1 < residual.size(); ++i)
    if (residual[i] > 1e-12) CHECK(residual[i + 1] < residual[i]);
  CHECK(residual.back() < 1e-14);
  CHECK(newton_residual(scene.rods[0], 0.02) < 1e-14);
}

TEST_CASE("with a single joint an XPBD iteration is a Newton iteration") {
  for (const int iterations : {1, 2, 3}) {
    const Scene start = test::moving_scene(2);
    Simulation newton(start, {0.02, iterations, 0});
    newton.step();
    const Scene xpbd = test::after<XpbdProjection>(start, 0.02, iterations);
    REQUIRE(test::distance(newton.scene, start, &Rod::position) > 1e-3);
    CHECK(test::distance(xpbd, newton.scene, &Rod::position) < 1e-14);
    CHECK((xpbd.rods[0].lambda - newton.rod().lambda).norm() < 1e-10 * newton.rod().lambda.norm());
  }
}

TEST_CASE("converged XPBD is Newton's step, to O(dt^4) in positions and O(dt^3) in velocities") {
  // They differ in the positions at which J is evaluated. These are O(dt^2) apart.
  const Scene start = falling(1e6);
  for (const double order : orders(start, &Rod::position, 0.01, 5000)) CHECK(order == Approx(4).margin(0.6));
  for (const double order : orders(start, &Rod::velocity, 0.01, 5000)) CHECK(order == Approx(3).margin(0.6));
  const Scene newton = test::after_newton(start, 1e-3), xpbd = test::after<XpbdProjection>(start, 1e-3, 5000);
  CHECK(test::distance(xpbd, newton, &Rod::position) < 1e-10);
}

TEST_CASE("where steps resolve all stiffness, every XPBD iteration gains two orders of the step on Newton") {
  // alpha~ = alpha/dt^2 outgrows J M^-1 J^T: an iteration leaves a fraction O(dt^2) of a correction of O(dt^2).
  const Scene start = falling(1e4, 1e-4);
  for (const double order : orders(start, &Rod::position, 1e-3, 1)) CHECK(order == Approx(4).margin(0.5));
  for (const double order : orders(start, &Rod::position, 2e-3, 2)) CHECK(order == Approx(6).margin(0.7));
}

TEST_CASE("where steps do not resolve the stiffness, few XPBD iterations leave a share of the correction, O(dt^2)") {
  const Scene start = falling(1e6);
  for (const double order : orders(start, &Rod::position, 0.02, 4)) CHECK(order == Approx(2).margin(0.4));
}

}  // namespace rodsweep::test_xpbd
