#include "solver/guess/subspace_guess.hpp"

#include <algorithm>

namespace rodsweep {
namespace {

constexpr double smallest_deflating_pivot = 1e-6;

}  // namespace

SubspaceGuess::SubspaceGuess(const Scene& scene, int newton_iterations, int size, Window window, Use use)
    : newton_iterations_(newton_iterations),
      size_(size),
      window_(window),
      order_(Eigen::VectorXi::Zero(size)),
      gram_(size, size),
      coefficients_(VectorX::Zero(size)),
      equations_(size),
      deflating_equations_(size, smallest_deflating_pivot),
      of_residual_(VectorX::Zero(size)) {
  for (const Rod& rod : scene.rods) {
    const StoredVectors none(6 * rod.joint_count(), size);
    histories_.insert(histories_.end(), static_cast<std::size_t>(newton_iterations), History{none});
    if (use == Use::guess_and_deflation) products_.push_back(none);
  }
}

SubspaceGuess::History& SubspaceGuess::history(const SolvePosition& at) {
  return histories_[static_cast<std::size_t>(at.rod * newton_iterations_ + at.newton)];
}

Proposal SubspaceGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  History& h = history(at);
  deflating_ = nullptr;
  if (h.last_step != at.step - 1 || h.known == 0) {
    x0.setZero();
    return {};
  }
  h.solutions.project(system.matrix(), system.rhs(), gram_, coefficients_);
  for (int i = 0; i < h.known; ++i) order_[i] = by_age(h, i);
  fill(h, equations_);
  solve(h, equations_, coefficients_);
  h.solutions.combine(coefficients_, x0);
  if (!products_.empty()) {
    deflating_ = &h;
    fill(h, deflating_equations_);
    deflating_products_ = &products_[static_cast<std::size_t>(at.rod)];
    deflating_products_->multiply(system.matrix(), h.solutions);
  }
  return {true, h.known};
}

void SubspaceGuess::fill(const History& h, NormalEquations& equations) {
  for (int k = 0; k < h.known; ++k)
    for (int i = 0; i < h.known; ++i) equations.gram(i, k) = gram_(order_[i], order_[k]);
  equations.factorise(h.known);
}

void SubspaceGuess::solve(const History& h, NormalEquations& equations, VectorX& c) {
  for (int i = 0; i < h.known; ++i) equations.right_side(i) = c[order_[i]];
  equations.solve();
  c.setZero();
  for (int i = 0; i < h.known; ++i) c[order_[i]] = equations.coefficient(i);
}

void SubspaceGuess::reduce(double* r) {
  deflating_->solutions.dots(r, of_residual_);
  solve(*deflating_, deflating_equations_, of_residual_);
  deflating_products_->subtract(of_residual_, r);
}

void SubspaceGuess::complete(double* z) {
  deflating_products_->dots(z, coefficients_);
  solve(*deflating_, deflating_equations_, coefficients_);
  coefficients_ -= of_residual_;
  deflating_->solutions.subtract(coefficients_, z);
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
