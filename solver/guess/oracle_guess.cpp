#include "solver/guess/oracle_guess.hpp"

#include <cmath>
#include <random>

#include "solver/numbers/counter_random.hpp"

namespace rodsweep {

OracleGuess::OracleGuess(const Scene& scene, double error, Error kind, std::uint64_t seed)
    : error_(error), kind_(kind), seed_(seed), noise_(unknowns_of(scene)), scratch_(unknowns_of(scene)) {
  for (const Rod& rod : scene.rods) factors_.emplace_back(LinearSystem(rod).matrix(), root_to_leaf_order(rod));
}

Proposal OracleGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  const BlockMatrix& a = system.matrix();
  BlockFactor& factor = factors_[static_cast<std::size_t>(at.rod)];
  VectorX &noise = noise_[static_cast<std::size_t>(at.rod)], &scratch = scratch_[static_cast<std::size_t>(at.rod)];
  if (factor.solve(a, system.rhs(), x0) != SolveOutcome::converged) {
    x0.setZero();
    return {};
  }
  const double solution = std::sqrt(energy_norm_squared(a, x0, scratch));
  // One stream per solve, so that the draw does not depend on what was solved before.
  std::uint64_t stream = split_mix(seed_);
  for (const int part : {at.step, at.newton, at.rod}) stream = split_mix(stream + static_cast<std::uint64_t>(part));
  std::mt19937_64 engine(stream);
  std::normal_distribution<double> normal;
  for (double& entry : noise) entry = normal(engine);
  if (kind_ == Error::smooth) {
    scratch = noise;
    factor.solve(a, scratch, noise);
  }
  const double size = std::sqrt(energy_norm_squared(a, noise, scratch));
  x0 += error_ * solution / size * noise;
  return {true, 0};
}

}  // namespace rodsweep
