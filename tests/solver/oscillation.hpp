// Frequency and decay of a sampled oscillation.
//
// Implicit Euler replaces exp(i w dt) by 1 / (1 - i w dt): the observed frequency is atan(w dt) / dt, and each step
// multiplies the amplitude by (1 + w^2 dt^2)^-1/2.
#pragma once

#include <cmath>
#include <complex>
#include <vector>

#include "tests/solver/dense.hpp"
#include "tests/solver/simulation.hpp"

namespace rodsweep {

/// The complex factor z per step of samples y'' ~ -w^2 y. Least-squares fit of y(k + 1) - 2 Re(z) y(k) + |z|^2 y(k - 1) =
/// 0 to every `stride`-th sample.
inline std::complex<double> factor_per_step(const std::vector<double>& samples, std::size_t stride) {
  const std::size_t rows = samples.size() - 2 * stride;
  test::MatrixX known(rows, 2);
  VectorX next(rows);
  for (std::size_t k = 0; k < rows; ++k) {
    const Eigen::Index row = static_cast<Eigen::Index>(k);
    known.row(row) << samples[k + stride], -samples[k];
    next[row] = samples[k + 2 * stride];
  }
  const VectorX fit = test::least_squares(known, next);
  const double size = std::sqrt(fit[1]), power = 1 / static_cast<double>(stride);
  return std::polar(std::pow(size, power), std::acos(fit[0] / (2 * size)) * power);
}

/// The factor of a small free oscillation of a scene's rod. Samples are displacements weighted by initial velocities, of
/// BDF2 after its first steps.
inline std::complex<double> factor_per_step(Scene scene, double dt, int steps, std::size_t stride,
                                            Integrator integrator = Integrator::euler) {
  const std::vector<Vector3> weight = scene.rods.front().velocity, rest = scene.rods.front().position;
  Simulation simulation(std::move(scene), StepSettings{dt, 12, 1e-14, integrator});
  if (integrator == Integrator::bdf2) simulation.run(20);  // the first is Euler's; the second root decays
  std::vector<double> samples;
  for (int i = 0; i < steps; ++i) {
    simulation.step();
    double sum = 0;
    for (std::size_t s = 0; s < rest.size(); ++s) sum += weight[s].dot(simulation.rod().position[s] - rest[s]);
    samples.push_back(sum);
  }
  return factor_per_step(samples, stride);
}

}  // namespace rodsweep
