// Simulations recorded by direct solves, as a training set holds them.
#pragma once

#include "network/recorded_simulation.hpp"
#include "solver/time_step.hpp"

namespace rodsweep::test {

/// Records the systems of the first `iterations` Newton iterations while it solves directly.
class RecordingDirectSolve : public LinearSolve {
 public:
  RecordingDirectSolve(const Scene& scene, int iterations, RecordedSimulation& out)
      : scene_(scene), direct_(scene), iterations_(iterations), out_(out) {}
  SolveOutcome solve(const LinearSystem& system, const SolvePosition& at, double assemble_s,
                     VectorX& delta_lambda) override {
    const SolveOutcome outcome = direct_.solve(system, at, assemble_s, delta_lambda);
    const Rod& rod = scene_.rods[static_cast<std::size_t>(at.rod)];
    if (at.newton < iterations_)
      out_.systems.push_back(
          {at, rod.position, rod.orientation, rod.velocity, rod.angular_velocity, rod.lambda, delta_lambda});
    return outcome;
  }

 private:
  const Scene& scene_;
  DirectSolve direct_;
  int iterations_;
  RecordedSimulation& out_;
};

inline RecordedSimulation recorded(Scene scene, int steps, int iterations = 1, double dt = 0.02) {
  TimeStepper stepper(scene, {dt, 4, 1e-9});
  RecordedSimulation out{scene, dt, stepper.constraint_dt(), 4, {}};
  RecordingDirectSolve solve(scene, iterations, out);
  LinearProjection projection(scene, solve);
  for (int step = 0; step < steps; ++step) stepper.step(projection);
  return out;
}

}  // namespace rodsweep::test
