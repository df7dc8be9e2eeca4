// Energy and momenta of the time step over long runs: implicit Euler dissipates energy to first order in the step,
// never gains any, and conserves linear momentum.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "solver/step/observables.hpp"
#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_validation_budgets {

/// A short stiff rod that swings about its clamp.
Scene swinging_rod() {
  BendingRod p;
  p.segments = 6;
  p.length_m = 1;
  p.youngs_modulus_pa = 1e6;
  return build_scene(p);
}

/// Momentum tolerances: none for the paper's step, 1e-9 for a step that keeps the balance.
using Balance = std::optional<double>;
const Balance kinds[] = {std::nullopt, 1e-9};

/// Energy lost in half a second over the largest kinetic energy.
double dissipation(double dt, Balance balance) {
  Simulation simulation(swinging_rod(), dt, 12, balance);
  const double start = mechanical_energy(simulation.scene);
  double largest = 0;
  for (int i = 0; i < static_cast<int>(std::lround(0.5 / dt)); ++i) {
    simulation.step();
    largest = std::max(largest, kinetic_energy(simulation.rod()));
  }
  return (start - mechanical_energy(simulation.scene)) / largest;
}

/// A free, weightless, bent scene in flight and rotation.
Scene tumbling(Scene scene) {
  scene.gravity_m_s2.setZero();
  Rod& rod = scene.rods.front();
  const Vector3 spin(0.4, -0.3, 1), centre = rod.position[rod.position.size() / 2];
  test::set_rigid_velocity(rod, Vector3(0.1, 0.2, -0.3) - spin.cross(centre), spin);
  for (std::size_t s = 0; s < rod.position.size(); ++s)
    rod.velocity[s].z() += 0.3 * std::sin(0.9 * static_cast<double>(s));
  return scene;
}

Scene tumbling_rod() {
  BendingRod p;
  p.segments = 8;
  p.clamp = Clamp::free;
  return tumbling(build_scene(p));
}

Scene tumbling_ring() {
  Ring p;
  p.segments = 12;
  p.clamp = Clamp::free;
  return tumbling(build_scene(p));
}

TEST_CASE("A swinging rod loses energy in proportion to the step") {
  for (const Balance balance : kinds) {
    const double coarse = dissipation(1e-3, balance), middle = dissipation(5e-4, balance);
    const double fine = dissipation(2.5e-4, balance);
    CAPTURE(balance.has_value(), coarse, middle, fine);
    CHECK(fine > 0);
    CHECK(coarse < 0.3);
    CHECK(std::log2(coarse / middle) == Approx(1).margin(0.15));
    CHECK(std::log2(middle / fine) == Approx(1).margin(0.1));
  }
}

TEST_CASE("Energy never grows by itself, in an open rod or a closed one") {
  const Balance balance = GENERATE(from_range(std::begin(kinds), std::end(kinds)));
  for (const Scene& scene : {swinging_rod(), tumbling_rod(), tumbling_ring()}) {
    Simulation simulation(scene, 5e-3, 12, balance);
    double before = mechanical_energy(simulation.scene);
    const double scale = kinetic_energy(scene.rods.front()) + std::abs(before);
    for (int i = 0; i < 400; ++i) {
      CHECK(simulation.step().balanced == balance.has_value());
      const double now = mechanical_energy(simulation.scene);
      REQUIRE(now < before + 1e-5 * scale);
      before = now;
    }
  }
}

TEST_CASE("Ten thousand steps leave linear momentum, unit quaternions and closed joints as they are") {
  const Balance balance = GENERATE(from_range(std::begin(kinds), std::end(kinds)));
  for (const Scene& scene : {tumbling_rod(), tumbling_ring()}) {
    Simulation simulation(scene, 5e-3, 6, balance);
    const Vector3 before = linear_momentum(simulation.rod());
    simulation.run(10000);
    CHECK((linear_momentum(simulation.rod()) - before).norm() < 1e-10 * before.norm());
    for (const Quaternion& q : simulation.rod().orientation) CHECK(std::abs(q.norm() - 1) < 1e-14);
    CHECK(joint_gap(simulation.rod()) < 1e-5);
  }
}

}  // namespace rodsweep::test_validation_budgets
