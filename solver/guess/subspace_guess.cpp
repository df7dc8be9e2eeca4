#include "solver/guess/subspace_guess.hpp"

#include <algorithm>

namespace rodsweep {
SubspaceGuess::SubspaceGuess(const Scene& scene, int newton_iterations, int size, Window window)
    : newton_iterations_(newton_iterations),
      size_(size),
      window_(window),
      gram_(size, size),
      right_side_(size),
      coefficients_(VectorX::Zero(size)),
      equations_(size) {
  for (const Rod& rod : scene.rods)
    histories_.insert(histories_.end(), static_cast<std::size_t>(newton_iterations),
                      History{StoredVectors(6 * rod.joint_count(), size)});
}

SubspaceGuess::History& SubspaceGuess::history(const SolvePosition& at) {
  return histories_[static_cast<std::size_t>(at.rod * newton_iterations_ + at.newton)];
}

Proposal SubspaceGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  History& h = history(at);
  if (h.last_step != at.step - 1 || h.known == 0) {
    x0.setZero();
    return {};
  }
  h.solutions.project(system.matrix(), system.rhs(), gram_, right_side_);
  const auto by_age = [&](int age) { return (h.newest - age + size_) % size_; };
  for (int i = 0; i < h.known; ++i) {
    equations_.right_side(i) = right_side_[by_age(i)];
    for (int k = 0; k <= i; ++k)
      equations_.gram(i, k) = gram_(std::max(by_age(i), by_age(k)), std::min(by_age(i), by_age(k)));
  }
  equations_.factorise(h.known);
  equations_.solve();
  coefficients_.setZero();
  for (int i = 0; i < h.known; ++i) coefficients_[by_age(i)] = equations_.coefficient(i);
  h.solutions.combine(coefficients_, x0);
  return {true, h.known};
}

void SubspaceGuess::accept(const SolvePosition& at, const VectorX& solution) {
  History& h = history(at);
  const bool again = h.last_step != at.step - 1 || (window_ == Window::restarted && h.known == size_);
  if (again) h.known = 0;
  h.newest = again ? 0 : (h.newest + 1) % size_;
  h.known = std::min(h.known + 1, size_);
  h.last_step = at.step;
  h.solutions.set(h.newest, solution);
}

}  // namespace rodsweep
