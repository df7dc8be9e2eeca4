// Motion against the invariants of every such discretisation: free fall, momenta, energy, first order in dt, quadratic
// convergence of Newton.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "solver/step/observables.hpp"
#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/stepping.hpp"

namespace rodsweep::test_validation_motion {

/// A bending rod of Shao et al. 2021: N = 20, 2 m, r = 0.05 m, first segment held, initial angle 20 degrees.
BendingRod deck_rod() {
  BendingRod p;
  p.segments = 20;
  p.youngs_modulus_pa = 1e5;
  p.initial_angle_deg = 20;
  return p;
}

/// A free rod without gravity that bends in two planes, spins and drifts. Velocities of segments are compatible.
Scene tumbling_rod() {
  BendingRod p = deck_rod();
  p.clamp = Clamp::free;
  p.gravity_m_s2.setZero();
  Scene scene = build_scene(p);
  Rod& rod = scene.rods.front();
  const Vector3 axis = director(rod.orientation.front());
  const auto vertex_velocity = [&](double s) -> Vector3 {  // s in [0, 1] along the rod
    return Vector3(0.3, -0.2, 0.1) + axis.cross(Vector3(0.7 * std::sin(pi * s), 0.5 * s * s, 1.5 * s - 0.4));
  };
  const double n = static_cast<double>(rod.segments.size());
  for (std::size_t i = 0; i < rod.segments.size(); ++i) {
    const double start = static_cast<double>(i) / n, end = static_cast<double>(i + 1) / n;
    const Vector3 before = vertex_velocity(start), after = vertex_velocity(end);
    rod.velocity[i] = (before + after) / 2;
    rod.angular_velocity[i] = axis.cross(after - before) / rod.segments[i].length_m + 2 * axis;
  }
  return scene;
}

/// Relative change of the angular momentum of the tumbling rod in half a second.
double angular_momentum_drift(double dt) {
  Simulation simulation(tumbling_rod(), dt);
  const Vector3 before = angular_momentum(simulation.rod());
  simulation.run(static_cast<int>(std::lround(0.5 / dt)));
  return (angular_momentum(simulation.rod()) - before).norm() / before.norm();
}

std::vector<Vector3> deck_rod_after(double time, double dt) {
  Simulation simulation(build_scene(deck_rod()), dt);
  simulation.run(static_cast<int>(std::lround(time / dt)));
  return simulation.rod().position;
}

double distance(const std::vector<Vector3>& a, const std::vector<Vector3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum);
}

TEST_CASE("A free rod falls by the sum that the steps make of gravity") {
  BendingRod p = deck_rod();
  p.clamp = Clamp::free;
  p.segments = GENERATE(1, 20);
  p.gravity_m_s2 = {1, -9.81, 2};
  const double dt = 0.02;
  const int steps = 100;
  Simulation simulation(build_scene(p), dt);
  const std::vector<Vector3> start = simulation.rod().position;
  const std::vector<Quaternion> orientation = simulation.rod().orientation;
  for (int n = 1; n <= steps; ++n) {
    simulation.step();
    const Vector3 fall = p.gravity_m_s2 * (dt * dt * n * (n + 1) / 2);
    double worst = 0, turned = 0;
    for (std::size_t s = 0; s < start.size(); ++s) {
      worst = std::max(worst, (simulation.rod().position[s] - start[s] - fall).norm());
      turned = std::max(turned, rotation(simulation.rod().orientation[s], orientation[s]).norm());
    }
    REQUIRE(worst <= 1e-12 * std::max(1.0, fall.norm()));
    REQUIRE(turned < 1e-12);
  }
  CHECK((simulation.rod().velocity[0] - p.gravity_m_s2 * steps * dt).norm() < 1e-11);
}

TEST_CASE("A free rod without gravity keeps its linear momentum, and its angular momentum to the order of the step") {
  Simulation simulation(tumbling_rod(), 0.01);
  const Vector3 before = linear_momentum(simulation.rod());
  simulation.run(100);
  CHECK(elastic_energy(simulation.rod()) > 1e-3);  // it bent
  CHECK((linear_momentum(simulation.rod()) - before).norm() < 1e-12 * before.norm());

  const double coarse = angular_momentum_drift(4e-3), fine = angular_momentum_drift(2e-3);
  CHECK(coarse < 1e-3);
  CHECK(std::log2(coarse / fine) == Approx(1).margin(0.1));
}

/// v^2 / gL of the free end of a chain of length L that hangs in a U from two points at one height and is let go at one of
/// them, when the end has fallen by x L.
double falling_end(int segments, double x, double dt) {
  RodParameters p;
  p.radius_m = 1e-3;
  p.youngs_modulus_pa = p.torsion_modulus_pa = 1;  // no stiffness to speak of
  const double edge = 1.0 / segments;
  std::vector<Vector3> vertices;
  for (int i = 0; i <= segments; ++i) {
    const int down = (segments - 1) / 2, depth = std::min(i, segments - i);
    vertices.emplace_back(i <= down ? 0 : edge, -edge * depth, 0);
  }
  std::vector<SegmentSpec> specs = segments_through(vertices, p);
  specs.insert(specs.begin(), held_point(vertices.front(), specs.front().orientation));
  Scene scene;
  scene.rods.push_back(chain(specs, p, 1e-2));
  Simulation simulation(scene, {dt, 30, 1e-12, Integrator::bdf2}, 1e-8);
  Vector3 before = tip(simulation.rod()), now = before;
  while (now.y() > -x) {
    before = now;
    simulation.step();
    now = tip(simulation.rod());
  }
  return (now - before).squaredNorm() / (dt * dt * 9.81);
}

TEST_CASE("The free end of a folded chain falls faster than a stone, as the conservation of energy says") {
  // v^2 = g x (2L - x) / (L - x), where a stone has 2 g x (Calkin & March 1989).
  for (const double x : {0.25, 0.5, 0.75}) {
    const double expected = x * (2 - x) / (1 - x);
    CAPTURE(x);
    CHECK(falling_end(41, x, 5e-4) == Approx(expected).epsilon(0.05));
  }
}

TEST_CASE("The time step is of first order") {
  const double dt = 2e-3, time = 0.4;
  const auto coarse = deck_rod_after(time, dt), middle = deck_rod_after(time, dt / 2),
             fine = deck_rod_after(time, dt / 4);
  CHECK(std::log2(distance(coarse, middle) / distance(middle, fine)) == Approx(1.0).margin(0.1));
}

TEST_CASE("Newton's residual falls quadratically to the floor of rounding") {
  BendingRod p = deck_rod();
  p.youngs_modulus_pa = 1e4;  // a difficult case: six solves
  Scene scene = build_scene(p);
  DirectSolve direct(scene);
  LinearProjection projection(scene, direct);
  TimeStepper stepper(scene, {0.02, 9, 0});
  const double floor = 2 * std::numeric_limits<double>::epsilon() * p.segments;  // of the order of eps L / l
  int quadratic = 0;
  for (int step = 0; step < 25; ++step) {
    test::Recorder recorder(projection);
    stepper.step(recorder);
    const std::vector<double> r = recorder.residuals();
    REQUIRE(r.size() == 9);
    for (std::size_t k = 1; k + 1 < r.size(); ++k) {
      if (r[k] > 3e-3) continue;  // before quadratic convergence
      CHECK(r[k + 1] < 30 * r[k] * r[k] + floor);
      if (r[k + 1] > floor) ++quadratic;
    }
    CHECK(r.back() < floor);
  }
  CHECK(quadratic > 30);  // iterations with quadratic convergence above the floor
}

}  // namespace rodsweep::test_validation_motion
