// Physical stretching and shearing: compliance, energy, closed forms for pulled and sheared rods.
#include <catch2/catch.hpp>
#include <cmath>

#include "solver/step/gauss_seidel.hpp"
#include "solver/step/observables.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_physical_stretch {

/// A weightless rod along +x, held by a wall.
BendingRod rod_of(int segments, double youngs_modulus, double torsion_modulus, Stretch stretch) {
  BendingRod p;
  p.segments = segments;
  p.clamp = Clamp::wall;
  p.youngs_modulus_pa = youngs_modulus;
  p.torsion_modulus_pa = torsion_modulus;
  p.stretch = stretch;
  p.gravity_m_s2.setZero();
  return p;
}

/// The tip at rest under a force on the last segment's centre. The prediction of such a force turns no segment.
Vector3 settled_tip(const BendingRod& p, const Vector3& force) {
  Scene scene = build_scene(p);
  scene.loads.push_back({0, scene.rods.front().segment_count() - 1, force, Vector3::Zero(), Vector3::Zero()});
  Simulation simulation(std::move(scene), 1);
  simulation.relax(1e-11);
  return tip(simulation.rod());
}

TEST_CASE("elastic energy of physical stretch is EA and kappa G A times half the squared strains") {
  BendingRod p = rod_of(2, 3e6, 1e6, Stretch::physical);
  p.clamp = Clamp::free;
  Rod rod = build_scene(p).rods.front();  // joint of length 1
  const double area = pi * 0.0025;
  rod.position[1] += Vector3(3e-3, 0, 0);
  CHECK(elastic_energy(rod) == Approx(3e6 * area * 9e-6 / 2).epsilon(1e-10));
  rod.position[1] += Vector3(-3e-3, 0, 4e-3);
  CHECK(elastic_energy(rod) == Approx(circle(1, 0.5).shear_coefficient * 1e6 * area * 16e-6 / 2).epsilon(1e-10));
}

TEST_CASE("a pulled rod stretches by F L / EA, but for half a segment at its end that is rigid") {
  const double e = 1e7, area = pi * 0.0025, force = 1e-3 * e * area;
  for (const int n : {1, 5, 40}) {
    const double law =
        force / (e * area) * (2 - 1.0 / n);  // lengths of the joints: half a segment at the wall, then one each
    const Vector3 end = settled_tip(rod_of(n, e, 4e6, Stretch::physical), force * Vector3::UnitX());
    CHECK(end.x() - 2 == Approx(law).epsilon(1e-8));
    CHECK(std::abs(end.y()) + std::abs(end.z()) < 1e-10);
  }
}

TEST_CASE("a rod under its own weight stretches by w L^2 / 2 EA") {
  BendingRod p = rod_of(40, 1e7, 4e6, Stretch::physical);
  p.initial_angle_deg = -90;
  p.gravity_m_s2 = Vector3(0, -9.81, 0);
  Simulation simulation(build_scene(p), 1);
  simulation.relax(1e-11);
  // Joint k carries n - k segments over the length l (the wall's joint over l / 2): the sum is w L^2 / 2 EA exactly.
  const double law = 1000 * 9.81 * 4 / 2 / 1e7;
  CHECK(-tip(simulation.rod()).y() - 2 == Approx(law).epsilon(1e-6));
}

TEST_CASE("a transverse force shears a rod by F L / kappa G A beyond its bending") {
  const double e = 1e8, g = 2e6, stiffness = circular_section(0.05, e, g).shear_n;
  const double force = 1e-4 * stiffness;
  for (const int n : {5, 20}) {
    const Vector3 pushed = settled_tip(rod_of(n, e, g, Stretch::physical), force * Vector3::UnitY());
    const Vector3 bent = settled_tip(rod_of(n, e, g, Stretch::inextensible), force * Vector3::UnitY());
    CHECK(pushed.y() - bent.y() == Approx(force * (2 - 1.0 / n) / stiffness).epsilon(2e-3));
  }
}

TEST_CASE(
    "a free rod that stretches physically keeps its linear momentum; its spin drifts with the step and the strain") {
  const auto drift = [](Stretch stretch) {
    BendingRod p = rod_of(10, 1e7, 4e6, stretch);
    p.clamp = Clamp::free;
    Scene scene = build_scene(p);
    Rod& rod = scene.rods.front();
    test::set_rigid_velocity(rod, {1, 2, 3}, {0.3, 1, 2});
    const Vector3 momentum = linear_momentum(rod), turning = angular_momentum(rod);
    Simulation simulation(std::move(scene), 1e-3);
    simulation.run(500);
    CHECK((linear_momentum(simulation.rod()) - momentum).norm() < 1e-11 * momentum.norm());
    return (angular_momentum(simulation.rod()) - turning).norm() / turning.norm();
  };
  CHECK(drift(Stretch::physical) < 2 * drift(Stretch::inextensible) + 1e-4);
}

TEST_CASE("xpbd stretches physically too: it leaves the residual of Newton's fixed point") {
  BendingRod p = test::bending_rod(5);
  p.stretch = Stretch::physical;
  Scene scene = build_scene(p);
  XpbdProjection projection(scene);
  TimeStepper stepper(scene, {0.01, 5000, 1e-12});
  for (int i = 0; i < 5; ++i) REQUIRE(stepper.step(projection).outcome == SolveOutcome::converged);
  CHECK(newton_residual(scene.rods.front(), scene.rods.front().constraint_dt) < 1e-11);
  CHECK(joint_gap(scene.rods.front()) > 1e-4);
}

}  // namespace rodsweep::test_physical_stretch
