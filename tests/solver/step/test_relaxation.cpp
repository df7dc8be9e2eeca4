// Steps with kinetic damping end at the equilibrium, whatever their size, and nowhere else.
#include <cmath>

#include "solver/step/relaxation.hpp"
#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/stepping.hpp"

namespace rodsweep::test_relaxation {

struct Rest {
  Scene scene;
  int steps;  ///< -1: not at rest
};

Rest at_rest(const Scene& start, double dt, double tolerance, int most = 3000) {
  Simulation simulation(start, {dt, 20, 1e-9}, tolerance);
  Relaxation relaxation(start, tolerance, dt);
  for (int step = 1; step <= most; ++step) {
    simulation.step();
    if (relaxation.settle(simulation.scene)) return {simulation.scene, step};
  }
  return {simulation.scene, -1};
}

TEST_CASE("kinetic damping ends in the equilibrium of dynamic relaxation, for any step") {
  BendingRod loaded = weightless_cantilever(20, 1e7, 4e6);
  loaded.tip_force_n = {0, -60, 20};
  BendingRod hanging;
  hanging.clamp = Clamp::wall;
  hanging.segments = 20;
  hanging.youngs_modulus_pa = 1e5;
  for (const BendingRod& p : {loaded, hanging}) {
    const Scene start = build_scene(p);
    Simulation reference(start, 0.5, 40, 1e-9);
    reference.relax(1e-8);
    for (const double dt : {0.005, 0.02, 0.05}) {
      const Rest rest = at_rest(start, dt, 1e-6);
      CHECK(rest.steps > 0);
      CHECK(test::distance(rest.scene, reference.scene, &Rod::position) < 1e-4 * p.length_m);
    }
  }
}

// The elastica beyond Euler's load: a column of P / P_E > 1 whose end turns by alpha has sqrt(P / P_E) = 2 K(k) / pi,
// k = sin(alpha / 2).
TEST_CASE("a column beyond Euler's load comes to rest as the elastica") {
  const double alpha = 1;
  BendingRod p = weightless_cantilever(60, 1e7, 4e6);
  const double stiffness = p.youngs_modulus_pa * pi * std::pow(p.radius_m, 4) / 4;
  const double euler = stiffness * std::pow(pi / (2 * p.length_m), 2);
  p.tip_force_n = {-euler * std::pow(2 * std::comp_ellint_1(std::sin(alpha / 2)) / pi, 2), 0, 0};
  Scene start = build_scene(p);
  start.rods[0].velocity.back().y() = 0.1;  // straight is an equilibrium too
  const Rest rest = at_rest(start, 0.02, 1e-6);
  CHECK(rest.steps > 0);
  const Vector3 end = director(rest.scene.rods[0].orientation.back());
  CHECK(std::atan2(std::abs(end.y()), end.x()) == Approx(alpha).epsilon(5e-3));
}

TEST_CASE("nothing is at rest that falls, or that a load or a motion will move") {
  BendingRod falling = weightless_cantilever(5, 1e7, 4e6);
  falling.clamp = Clamp::free;
  falling.gravity_m_s2 = {0, -9.81, 0};
  CHECK(at_rest(build_scene(falling), 0.02, 1e-3, 100).steps == -1);

  BendingRod loaded = weightless_cantilever(5, 1e9, 4e8);
  PrescribedLoad later;
  later.at_m = {2, 0, 0};
  later.force_n = {0, 1, 0};
  later.schedule = {{1, 1.1}, {0, 1}, false};
  loaded.prescribed.loads.push_back(later);
  CHECK(at_rest(build_scene(loaded), 0.02, 1e-3, 50).steps == -1);
  const Rest rest = at_rest(build_scene(loaded), 0.02, 1e-3);
  CHECK(rest.scene.time_s > 1.1);
  CHECK(rest.steps > 0);

  loaded.prescribed.loads[0].schedule = {{0, 0.5, 1}, {0, 1, 0}, false};  // passes its last value at first
  CHECK(at_rest(build_scene(loaded), 0.02, 1e-3).scene.time_s >= 1);

  BendingRod moved = weightless_cantilever(5, 1e9, 4e8);
  moved.tip_motion = TipMotion{{-0.1, 0, 0}, {0, 0, 0}, 1};
  CHECK(at_rest(build_scene(moved), 0.02, 1e-3).scene.time_s >= 1);
}

}  // namespace rodsweep::test_relaxation
