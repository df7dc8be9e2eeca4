#include "solver/guess/initial_guess.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "solver/numbers/split_mix.hpp"

namespace rodsweep {
namespace {

/// A vector of unknowns for every rod of the scene.
std::vector<VectorX> vectors_for(const Scene& scene) {
  std::vector<VectorX> out;
  for (const Rod& rod : scene.rods) out.push_back(VectorX::Zero(6 * rod.joint_count()));
  return out;
}

}  // namespace

ExtrapolationGuess::ExtrapolationGuess(const Scene& scene, int newton_iterations, int terms)
    : terms_(terms), newton_iterations_(newton_iterations) {
  for (const Rod& rod : scene.rods)
    for (int j = 0; j < newton_iterations; ++j) {
      History h;
      h.solutions.assign(at(terms), VectorX::Zero(6 * rod.joint_count()));
      histories_.push_back(std::move(h));
    }
}

ExtrapolationGuess::History& ExtrapolationGuess::history(const SolvePosition& at) {
  return histories_[static_cast<std::size_t>(at.rod * newton_iterations_ + at.newton)];
}

Proposal ExtrapolationGuess::propose(const LinearSystem&, const SolvePosition& at, VectorX& x0) {
  const History& h = history(at);
  const int known = h.last_step == at.step - 1 ? std::min(h.consecutive, terms_) : 0;
  const auto back = [&](int steps) -> const VectorX& { return h.solutions[at((h.newest - steps + terms_) % terms_)]; };
  switch (known) {
    case 0: x0.setZero(); break;
    case 1: x0 = back(0); break;
    case 2: x0 = 2 * back(0) - back(1); break;
    default: x0 = 3 * back(0) - 3 * back(1) + back(2);
  }
  return {known > 0, 0};
}

void ExtrapolationGuess::accept(const LinearSystem&, const SolvePosition& at, const VectorX& solution) {
  History& h = history(at);
  h.consecutive = h.last_step == at.step - 1 ? std::min(h.consecutive + 1, terms_) : 1;
  h.last_step = at.step;
  h.newest = (h.newest + 1) % terms_;
  h.solutions[at(h.newest)] = solution;
}

void ExtrapolationGuess::accept_total(int rod, int step, const VectorX& total) {
  History& h = history({step, 0, rod});
  if (h.last_step == step) h.solutions[at(h.newest)] = total;
}

OracleGuess::OracleGuess(const Scene& scene, double error, Error kind, std::uint64_t seed)
    : error_(error), kind_(kind), seed_(seed), noise_(vectors_for(scene)), scratch_(vectors_for(scene)) {
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

GuardedGuess::GuardedGuess(const Scene& scene, std::unique_ptr<InitialGuess> inner, double threshold)
    : inner_(std::move(inner)), threshold_(threshold), scratch_(vectors_for(scene)) {}

Proposal GuardedGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  const Proposal inner = inner_->propose(system, at, x0);
  used_ = true;
  if (!inner.nonzero) return inner;
  VectorX& residual = scratch_[static_cast<std::size_t>(at.rod)];
  if (inner.residual) {
    residual = *inner.residual;
  } else {
    system.multiply(x0.data(), residual.data());
    residual = system.rhs() - residual;
  }
  const int products = inner.start_products();
  const double limit = threshold_ * threshold_ * jacobi_norm_squared(system.matrix(), system.rhs());
  if (jacobi_norm_squared(system.matrix(), residual) < limit) return {true, products, &residual, inner.renewed};
  used_ = false;  // the residual of zero is not orthogonal to the space of a deflation
  x0.setZero();
  return {false, products, nullptr, inner.renewed};
}

Proposal FirstGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  used_ = at.newton == 0;
  if (used_) return inner_->propose(system, at, x0);
  x0.setZero();
  return {};
}

}  // namespace rodsweep
