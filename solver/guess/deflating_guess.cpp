#include "solver/guess/deflating_guess.hpp"

#include <algorithm>

namespace rodsweep {

DeflatingGuess::DeflatingGuess(const Scene& scene, int newton_iterations, int size)
    : newton_iterations_(newton_iterations),
      size_(size),
      gram_(size, size),
      right_side_(size),
      coefficients_(VectorX::Zero(size)),
      equations_(size) {
  for (const Rod& rod : scene.rods) {
    const StoredVectors none(6 * rod.joint_count(), size);
    histories_.insert(histories_.end(), static_cast<std::size_t>(newton_iterations), History{none});
    products_.push_back(none);
  }
}

DeflatingGuess::History& DeflatingGuess::history(const SolvePosition& at) {
  return histories_[static_cast<std::size_t>(at.rod * newton_iterations_ + at.newton)];
}

Proposal DeflatingGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  History& h = history(at);
  current_ = nullptr;
  if (h.last_step != at.step - 1 || h.known == 0) {
    x0.setZero();
    return {};
  }
  current_ = &h;
  current_products_ = &products_[static_cast<std::size_t>(at.rod)];
  current_products_->multiply(system.matrix(), h.solutions);
  h.solutions.project(system.matrix(), system.rhs(), gram_, right_side_);
  for (int i = 0; i < h.known; ++i) {
    const int row = (h.newest - i + size_) % size_;
    for (int k = 0; k <= i; ++k) {
      const int column = (h.newest - k + size_) % size_;
      equations_.gram(i, k) = gram_(std::max(row, column), std::min(row, column));
    }
  }
  equations_.factorise(h.known);
  coefficients_ = right_side_;
  solve(coefficients_);
  h.solutions.combine(coefficients_, x0);
  return {true, h.known};
}

void DeflatingGuess::solve(VectorX& c) {
  const History& h = *current_;
  for (int i = 0; i < h.known; ++i) equations_.right_side(i) = c[(h.newest - i + size_) % size_];
  equations_.solve();
  c.setZero();
  for (int i = 0; i < h.known; ++i) c[(h.newest - i + size_) % size_] = equations_.coefficient(i);
}

void DeflatingGuess::project(double* z) {
  current_products_->dots(z, coefficients_);
  solve(coefficients_);
  current_->solutions.subtract(coefficients_, z);
}

void DeflatingGuess::accept(const SolvePosition& at, const VectorX& solution) {
  History& h = history(at);
  const bool again = h.last_step != at.step - 1;
  if (again) h.known = 0;
  h.newest = again ? 0 : (h.newest + 1) % size_;
  h.known = std::min(h.known + 1, size_);
  h.last_step = at.step;
  h.solutions.set(h.newest, solution);
}

}  // namespace rodsweep
