// Numerical extremes: signs of quaternions, segments shorter than thick, extreme moduli, both ends held.
#include <catch2/catch.hpp>
#include <cmath>

#include "solver/step/observables.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_extremes {

/// The scene with every second quaternion negated, which is the same orientation.
Scene with_signs_flipped(Scene scene) {
  Rod& rod = scene.rods.front();
  for (std::size_t s = 0; s < rod.orientation.size(); s += 2) rod.orientation[s].coeffs() *= -1;
  return scene;
}

/// A straight rod along +x with this stretch compliance; its first and, if asked, its last segment are held.
Rod straight_rod(int n, bool both_ends, double stretch) {
  BendingRod p = test::bending_rod(n);
  p.initial_angle_deg = 0;
  p.stretch_compliance_per_j = stretch;
  Rod rod = build_scene(p).rods.front();
  if (!both_ends) return rod;
  Segment& last = rod.segments.back();
  last.is_static = true;
  last.inverse_mass = last.inverse_inertia_transverse = last.turn_mobility = last.inverse_inertia_axial = 0;
  return rod;
}

double condition_number(const Rod& rod, double dt) {
  const VectorX values = test::eigenvalues(test::assembled(rod, dt).matrix().dense());
  return values.maxCoeff() / values.minCoeff();
}

TEST_CASE("neighbouring quaternions in opposite hemispheres give the same motion, bit for bit") {
  Ring ring;
  ring.segments = 10;
  for (const SceneSpec& spec : {SceneSpec(test::bending_rod(9)), SceneSpec(Helix{}), SceneSpec(ring)}) {
    const Scene scene = build_scene(spec);
    Simulation plain(scene, 0.02), flipped(with_signs_flipped(scene), 0.02);
    plain.run(30);
    flipped.run(30);
    CHECK(plain.rod().position == flipped.rod().position);
    CHECK(plain.rod().angular_velocity == flipped.rod().angular_velocity);
    CHECK(plain.rod().lambda == flipped.rod().lambda);
  }
}

TEST_CASE("a rod whose segments are shorter than thick sags as any other") {
  BendingRod p = test::bending_rod(100, Clamp::wall);
  p.initial_angle_deg = 0;
  p.length_m = 2;
  p.radius_m = 0.1;  // segments of 0.02 m
  p.youngs_modulus_pa = 1e9;
  p.gravity_m_s2 /= 30;
  Simulation simulation(build_scene(p), 1);
  simulation.relax();
  const double law = 1000 * 9.81 / 30 * 16 / (8 * 1e9 * 0.01 / 4) * (1 + 1e-4);  // w L^4 / 8 EI, I / A = r^2 / 4
  CHECK(-tip(simulation.rod()).y() == Approx(law).epsilon(1e-3));
}

TEST_CASE("moduli from 1 Pa to 1e15 Pa keep rods together and Newton converging") {
  for (const double modulus : {1.0, 1e3, 1e9, 1e12, 1e15})
    for (const Stretch stretch : {Stretch::inextensible, Stretch::physical}) {
      if (stretch == Stretch::physical && modulus < 1e6) continue;  // its own weight tears such a rod
      BendingRod p = test::bending_rod(12);
      p.youngs_modulus_pa = p.torsion_modulus_pa = modulus;
      p.stretch = stretch;
      Simulation simulation(build_scene(p), {0.02, 20, 1e-9});
      INFO("modulus " << modulus << (stretch == Stretch::physical ? ", physical" : ""));
      for (int i = 0; i < 100; ++i) {
        simulation.step();
        REQUIRE(newton_residual(simulation.rod(), simulation.constraint_dt()) < 1e-8);
      }
      CHECK(is_finite(simulation.rod()));
      CHECK(joint_gap(simulation.rod()) < 1e-4);
      if (modulus >= 1e12)  // almost rigid
        CHECK((tip(simulation.rod()) - tip(build_scene(p).rods.front())).norm() < 1e-4);
    }
}

TEST_CASE(
    "the condition number of a rod held at both ends grows with the inverse compliance, of an open one it does not") {
  const double dt = 0.02;
  const auto growth = [&](bool both) {
    return condition_number(straight_rod(10, both, 1e-10), dt) / condition_number(straight_rod(10, both, 1e-9), dt);
  };
  CHECK(growth(true) == Approx(10).epsilon(0.1));
  CHECK(growth(false) == Approx(1).epsilon(0.01));
}

TEST_CASE("a rod held at both ends is solved to rounding for its condition number, and sags") {
  Scene scene = test::scene_of(straight_rod(20, true, 1e-9));
  scene.damping_per_s = 20;
  Simulation simulation(scene, 0.02);
  simulation.run(200);
  CHECK(simulation.rod().position[10].y() < -1e-3);
  simulation.rod().position[5] += Vector3(1e-4, 2e-4, 0);
  const LinearSystem system = test::assembled(simulation.rod());
  BlockFactor factor(system.matrix(), root_to_leaf_order(simulation.rod()));
  VectorX x(system.rhs().size());
  REQUIRE(factor.solve(system.matrix(), system.rhs(), x) == SolveOutcome::converged);
  CHECK((system.matrix().dense() * x - system.rhs()).norm() < 1e-9 * system.rhs().norm());
}

}  // namespace rodsweep::test_extremes
