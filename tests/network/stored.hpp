// Simulations as a data set stores them, and training examples made from them.
#pragma once

#include "network/training/example_builder.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test {

/// Steps the scene by direct solves and records every system.
inline StoredSimulation stored_simulation(Scene scene, int steps, int newton_iterations = 2) {
  StoredSimulation out;
  out.scene = scene;
  out.step_s = 0.02;
  out.newton_iterations = newton_iterations;
  observe(scene, {out.step_s, newton_iterations, 0}, steps,
          [&](const LinearSystem&, const SolvePosition& at, const VectorX& solution) {
            const Rod& rod = scene.rods[at.rod];
            out.systems.push_back({at, rod.constraint_dt, rod.position, rod.orientation, rod.velocity,
                                   rod.angular_velocity, rod.lambda, solution});
          });
  return out;
}

/// A rod whose segments, stiffness and initial angle depend on `number`.
inline Scene sample_scene(int number) {
  BendingRod rod = bending_rod(4 + number % 3);
  rod.initial_angle_deg = 10 + 7 * (number % 5);
  rod.youngs_modulus_pa = 1e5 * (1 + number);
  return build_scene(rod);
}

struct Examples {
  std::vector<Example> examples;
  FeatureScales scales;
};

/// Examples of several simulations, normalised by their own scales.
inline Examples sample_examples(const CopingNetSettings& settings, int simulations, int steps) {
  Examples out;
  for (int i = 0; i < simulations; ++i) add_examples(settings, stored_simulation(sample_scene(i), steps), out.examples);
  out.scales = feature_scales(settings, out.examples);
  normalise(settings, out.scales, out.examples);
  return out;
}

}  // namespace rodsweep::test
