// Scenes advanced by direct solves, and their relaxation to rest.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "solver/numbers/rotation.hpp"
#include "solver/scene/scene_parts.hpp"
#include "solver/step/observables.hpp"
#include "solver/step/time_step.hpp"

namespace rodsweep {

/// The free end of a chain of segments.
inline Vector3 tip(const Rod& rod) {
  return rod.position.back() + rod.segments.back().length_m / 2 * director(rod.orientation.back());
}

/// Kinetic, elastic and gravitational energy of all rods.
inline double mechanical_energy(const Scene& scene) {
  double sum = 0;
  for (const Rod& rod : scene.rods)
    sum += kinetic_energy(rod) + elastic_energy(rod) + gravitational_energy(rod, scene.gravity_m_s2);
  return sum;
}

/// A straight, weightless rod along +x that a wall holds.
inline BendingRod weightless_cantilever(int segments, double youngs_modulus_pa, double torsion_modulus_pa,
                                        double length_m = 2, double radius_m = 0.05) {
  BendingRod p;
  p.clamp = Clamp::wall;
  p.segments = segments;
  p.length_m = length_m;
  p.radius_m = radius_m;
  p.youngs_modulus_pa = youngs_modulus_pa;
  p.torsion_modulus_pa = torsion_modulus_pa;
  p.gravity_m_s2.setZero();
  return p;
}

/// Order of convergence from the errors at N and 2 N.
inline double order(double error_n, double error_2n) { return std::log2(std::abs(error_n / error_2n)); }

class Simulation {
 public:
  /// With a momentum tolerance, steps keep the balance of momentum.
  Simulation(Scene initial, const StepSettings& settings, std::optional<double> momentum_tolerance = {})
      : scene(std::move(initial)),
        dt_(settings.dt),
        direct_(scene),
        projection_(scene, direct_, momentum_tolerance),
        stepper_(scene, settings) {}
  /// Newton iterates to rounding: its tolerance is 1e-14.
  Simulation(Scene initial, double dt, int newton_iterations = 12, std::optional<double> momentum_tolerance = {})
      : Simulation(std::move(initial), StepSettings{dt, newton_iterations, 1e-14}, momentum_tolerance) {}
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// A step, whatever its outcome.
  StepReport try_step() { return stepper_.step(projection_); }
  StepReport step() {
    const StepReport report = try_step();
    if (report.outcome != SolveOutcome::converged)
      throw std::runtime_error(std::string("a step ended: ") + to_string(report.outcome));
    return report;
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) step();
  }

  /// Dynamic relaxation: takes a step, then zeroes the velocities. This is an implicit step of M x' = dt F, stable for
  /// steps of seconds, and its fixed point is the static equilibrium. Returns the largest motion of the step (m, rad).
  double relax_once() {
    step();
    double moved = 0;
    for (Rod& r : scene.rods)
      for (std::size_t s = 0; s < r.segments.size(); ++s) {
        moved = std::max({moved, dt_ * r.velocity[s].norm(), dt_ * r.angular_velocity[s].norm()});
        r.velocity[s].setZero();
        r.angular_velocity[s].setZero();
      }
    return moved;
  }
  /// Relaxes until no segment moves or turns by more than `motion` (m, rad) in a step.
  void relax(double motion = 1e-9) {
    for (int i = 0; i < 2000; ++i)
      if (relax_once() < motion) return;
    throw std::runtime_error("not at rest after 2000 steps of relaxation");
  }

  Reactions reactions() const { return stepper_.reactions(); }
  Rod& rod() { return scene.rods.front(); }
  double constraint_dt() const { return scene.rods.front().constraint_dt; }

  Scene scene;

 private:
  double dt_;
  DirectSolve direct_;
  LinearProjection projection_;
  TimeStepper stepper_;
};

/// A LinearSolve that calls a function of the system, its position and the solution; the function returns the outcome.
template <class Function>
class SolveBy : public LinearSolve {
 public:
  explicit SolveBy(const Function& function) : function_(function) {}
  SolveOutcome solve(const LinearSystem& system, const SolvePosition& at, double, VectorX& solution) override {
    return function_(system, at, solution);
  }

 private:
  Function function_;
};

/// Steps the scene by direct solves; calls `look` with every system, its position and its solution.
template <class Look>
void observe(Scene& scene, const StepSettings& settings, int steps, const Look& look) {
  DirectSolve direct(scene);
  SolveBy solve([&](const LinearSystem& system, const SolvePosition& at, VectorX& solution) {
    const SolveOutcome outcome = direct.solve(system, at, 0, solution);
    look(system, at, solution);
    return outcome;
  });
  LinearProjection projection(scene, solve);
  TimeStepper stepper(scene, settings);
  for (int step = 0; step < steps; ++step)
    if (stepper.step(projection).outcome != SolveOutcome::converged) throw std::runtime_error("a step failed");
}

}  // namespace rodsweep
