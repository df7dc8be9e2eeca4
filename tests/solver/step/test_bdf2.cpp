// BDF2 against closed forms and itself: second order for turns, twists, trees, loads, wind and drag, in both kinds of
// step; momentum in impacts. For symmetries see tests/laws/every_scene.cpp.
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "solver/step/gauss_seidel.hpp"
#include "solver/step/observables.hpp"
#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/stepping.hpp"
#include "tests/solver/support.hpp"
#include "tests/solver/touching.hpp"

namespace rodsweep::test_bdf2 {

using Balance = std::optional<double>;

StepSettings bdf2(double dt) { return {dt, 40, 1e-12, Integrator::bdf2}; }
StepSettings euler(double dt) { return {dt, 40, 1e-12, Integrator::euler}; }

Scene after(const Scene& scene, const StepSettings& settings, double time_s, Balance balance = {}) {
  Simulation simulation(scene, settings, balance);
  simulation.run(static_cast<int>(std::lround(time_s / settings.dt)));
  return simulation.scene;
}

/// The largest distance of segments, and of the tips of their axes x, a fifth of a metre long, so that twist counts.
double distance(const Scene& a, const Scene& b) {
  double most = 0;
  for (std::size_t r = 0; r < a.rods.size(); ++r)
    for (std::size_t s = 0; s < a.rods[r].segments.size(); ++s) {
      const auto tip = [&](const Scene& scene) -> Vector3 {
        return 0.2 * (scene.rods[r].orientation[s] * Vector3::UnitX());
      };
      most = std::max({most, (a.rods[r].position[s] - b.rods[r].position[s]).norm(), (tip(a) - tip(b)).norm()});
    }
  return most;
}

/// log2 of the ratio of the changes by halving the step, twice.
double order(const Scene& scene, double dt, double time_s, Balance balance = {}) {
  const Scene coarse = after(scene, bdf2(dt), time_s, balance), middle = after(scene, bdf2(dt / 2), time_s, balance);
  const Scene fine = after(scene, bdf2(dt / 4), time_s, balance);
  return std::log2(distance(coarse, middle) / distance(middle, fine));
}

/// Holds the first segment and moves and turns it smoothly; no other load.
Scene shaken(Scene scene) {
  scene.gravity_m_s2.setZero();
  const Pose at{scene.rods[0].position[0], scene.rods[0].orientation[0]};
  scene.clamps.push_back({0, 0, [at](double t) {
                            const double a = std::pow(std::sin(5 * t), 4);
                            const Eigen::AngleAxisd turn(0.6 * a, Vector3(1, 2, 2) / 3);
                            return Pose{at.position + a * Vector3(0, 0.1, 0.05), turn * at.orientation};
                          }});
  return scene;
}

BendingRod stiff_rod() {
  BendingRod rod = test::bending_rod(12, Clamp::segment);
  rod.youngs_modulus_pa = 1e6;
  return rod;
}

TEST_CASE("drag slows a free body by exp(-c t), with an error of second order") {
  double error[2];
  for (int i = 0; i < 2; ++i) {
    Scene scene = test::free_body();
    scene.damping_per_s = 3;
    Simulation sim(scene, bdf2(0.01 / (1 << i)));
    const Vector3 v0(1, -2, 3), w0 = 4 * director(sim.rod().orientation[0]);
    sim.rod().velocity[0] = v0;
    sim.rod().angular_velocity[0] = w0;
    sim.run(50 << i);
    const double left = std::exp(-1.5);
    error[i] = (sim.rod().velocity[0] - left * v0).norm() / v0.norm();
    CHECK((sim.rod().angular_velocity[0] - left * w0).norm() / w0.norm() == Approx(error[i]).epsilon(1e-6));
  }
  CHECK(error[1] < 1e-4);
  CHECK(std::log2(error[0] / error[1]) == Approx(2).margin(0.1));
}

TEST_CASE("free fall is exact but for the first step, which is one of Euler") {
  BendingRod p = stiff_rod();
  p.clamp = Clamp::free;
  const double dt = 0.02;
  Simulation simulation(build_scene(p), bdf2(dt));
  const Vector3 start = simulation.rod().position[3];
  simulation.run(60);
  const double t = 60 * dt;
  CHECK((simulation.rod().velocity[3] - t * p.gravity_m_s2).norm() < 1e-11);
  const Vector3 late = simulation.rod().position[3] - start - t * t / 2 * p.gravity_m_s2;
  CHECK((late - 0.75 * dt * dt * p.gravity_m_s2).norm() < 1e-11);  // (1/2)(1 + 1/3 + 1/9 + ...) dt^2
}

TEST_CASE("rods, helices and trees that are moved smoothly have errors of second order in both kinds of step") {
  Helix helix;
  helix.segments = 24;
  helix.windings = 1;
  helix.youngs_modulus_pa = helix.torsion_modulus_pa = 1e6;
  Tree tree;
  tree.shape.depth = tree.shape.branches = 2;
  tree.shape.segments = 3;
  tree.youngs_modulus_pa = tree.torsion_modulus_pa = 1e7;
  for (const Scene& scene : {build_scene(stiff_rod()), build_scene(helix), build_scene(tree)})
    for (const Balance balance : {Balance(), Balance(1e-9)}) {
      CAPTURE(scene.rods[0].segment_count(), balance.has_value());
      CHECK(order(shaken(scene), 0.0025, 0.6, balance) == Approx(2).margin(0.1));
    }
}

TEST_CASE("a rod that spins and bends in free space has an error of second order, and so has its angular momentum") {
  BendingRod p = stiff_rod();
  p.clamp = Clamp::free;
  p.gravity_m_s2.setZero();
  Scene scene = build_scene(p);
  Rod& rod = scene.rods.front();
  const Vector3 spin(5, 2, 8);
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    rod.angular_velocity[s] = spin;
    rod.velocity[s] = spin.cross(rod.position[s]);
  }
  CHECK(order(scene, 0.004, 0.4) == Approx(2).margin(0.2));
  CHECK(order(scene, 0.004, 0.4, 1e-9) == Approx(2).margin(0.2));
  const auto drift = [&](double dt) {
    const Scene end = after(scene, bdf2(dt), 0.4);
    CHECK((linear_momentum(end.rods[0]) - linear_momentum(rod)).norm() < 1e-10 * rod.segments[0].mass);
    return (angular_momentum(end.rods[0]) - angular_momentum(rod)).norm();
  };
  CHECK(std::log2(drift(0.002) / drift(0.001)) == Approx(2).margin(0.3));
}

/// Positions of all segments, every 0.02 s.
std::vector<Vector3> path(const Scene& scene, const StepSettings& settings, double time_s, Balance balance) {
  Simulation simulation(scene, settings, balance);
  const int every = static_cast<int>(std::lround(0.02 / settings.dt));
  std::vector<Vector3> out;
  for (int frame = 0; frame < std::lround(time_s / 0.02); ++frame) {
    simulation.run(every);
    out.insert(out.end(), simulation.rod().position.begin(), simulation.rod().position.end());
  }
  return out;
}

double difference(const std::vector<Vector3>& a, const std::vector<Vector3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

TEST_CASE("released under gravity, in wind and under a load, a rod's error at 0.02 s is a fraction of Euler's") {
  BendingRod falling = stiff_rod(), windy = stiff_rod();
  falling.gravity_m_s2 = {3, -8, 5};
  windy.wind.emplace();
  windy.wind->mean_m_s = {2, 0, 6};
  windy.wind->turbulence_m_s = 1;
  windy.damping_per_s = 0.5;
  Scene loaded = build_scene(stiff_rod());
  loaded.loads.push_back({0, 11, {3, 20, 10}, {0, 0, 0}, {0, 0, 0.05}});
  const std::pair<Scene, double> cases[]{{build_scene(falling), 4}, {build_scene(windy), 4}, {loaded, 3}};
  for (const auto& [scene, fraction] : cases)
    for (const Balance balance : {Balance(), Balance(1e-9)}) {
      const std::vector<Vector3> exact = path(scene, bdf2(0.02 / 64), 0.8, balance);
      const auto error = [&, &start = scene](const StepSettings& settings) {
        return difference(path(start, settings, 0.8, balance), exact);
      };
      CAPTURE(balance.has_value(), error(euler(0.02)), error(bdf2(0.02)), error(bdf2(0.01)));
      CHECK(error(bdf2(0.02)) < error(euler(0.02)) / fraction);
      CHECK(error(bdf2(0.01)) < error(bdf2(0.02)) / 3);
    }
}

TEST_CASE("Gauss-Seidel with enough iterations takes the same steps of BDF2 as the direct solve") {
  const Scene start = build_scene(test::bending_rod(4, Clamp::segment));
  Scene scene = start;
  XpbdProjection projection(scene);
  TimeStepper stepper(scene, {0.01, 3000, 1e-13, Integrator::bdf2});
  for (int i = 0; i < 10; ++i) stepper.step(projection);
  // Each of its corrections moves along another Jacobian.
  CHECK(distance(scene, after(start, bdf2(0.01), 0.1)) < 2e-3);
}

TEST_CASE("a swinging rod keeps its energy better than with Euler, and 20,000 steps do not let it grow") {
  const Scene start = build_scene(stiff_rod());
  const double before = mechanical_energy(start), scale = test::kinetic_energy(after(start, bdf2(0.001), 0.3));
  const double lost = before - mechanical_energy(after(start, bdf2(0.005), 0.6));
  CHECK(lost > 0);
  CHECK(lost < 0.02 * scale);
  CHECK(lost < (before - mechanical_energy(after(start, euler(0.005), 0.6))) / 10);

  Simulation simulation(start, {0.01, 6, 1e-9, Integrator::bdf2});
  double highest = -HUGE_VAL;
  for (int step = 0; step < 20000; ++step) {
    simulation.step();
    highest = std::max(highest, mechanical_energy(simulation.scene));
  }
  CHECK(highest < before + 1e-3 * scale);
  CHECK(joint_gap(simulation.rod()) < 1e-5);
}

TEST_CASE("bodies that collide in free space keep their momentum, though a third one lies still on another") {
  const Scene start = test::contact_scene({test::capsule({0, 0, 0}, {0.4, 0, 0}, {0, 0, 0}),
                                           test::capsule({0, 0, 0.1}, {0.4, 0, 0.1}, {0, 0, 0}),
                                           test::capsule({0.1, 0, -0.4}, {0.5, 0.1, -0.4}, {0, 0, 2})});
  Simulation simulation(start, bdf2(0.01));
  const Vector3 before = test::linear_momentum(start);
  double fastest = 0;
  for (int step = 0; step < 60; ++step) {
    simulation.step();
    fastest = std::max(fastest, simulation.scene.rods[1].velocity[0].z());
    CHECK((test::linear_momentum(simulation.scene) - before).norm() < 1e-9 * before.norm());
  }
  CHECK(fastest > 0.3);  // the push reached the one behind
}

}  // namespace rodsweep::test_bdf2
