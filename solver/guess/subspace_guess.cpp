#include "solver/guess/subspace_guess.hpp"

namespace rodsweep {
SubspaceGuess::SubspaceGuess(const Scene& scene, int newton_iterations, int size, Window window)
    : newton_iterations_(newton_iterations), size_(size), window_(window), equations_(size) {
  for (const Rod& rod : scene.rods) {
    const Matrix empty = Matrix::Zero(6 * rod.joint_count(), size);
    products_.push_back(empty);
    histories_.insert(histories_.end(), static_cast<std::size_t>(newton_iterations), History{empty});
  }
}

SubspaceGuess::History& SubspaceGuess::history(const SolvePosition& at) {
  return histories_[static_cast<std::size_t>(at.rod * newton_iterations_ + at.newton)];
}

Proposal SubspaceGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  const History& h = history(at);
  x0.setZero();
  if (h.last_step != at.step - 1 || h.known == 0) return {};
  Matrix& products = products_[static_cast<std::size_t>(at.rod)];
  for (int i = 0; i < h.known; ++i) system.matrix().multiply(h.solutions.col(i).data(), products.col(i).data());

  const auto by_age = [&](int age) { return (h.newest - age + size_) % size_; };
  for (int i = 0; i < h.known; ++i) {
    const auto solution = h.solutions.col(by_age(i));
    equations_.right_side(i) = solution.dot(system.rhs());
    for (int k = 0; k <= i; ++k) equations_.gram(i, k) = solution.dot(products.col(by_age(k)));
  }
  equations_.solve(h.known);
  for (int i = h.known - 1; i >= 0; --i) x0 += equations_.coefficient(i) * h.solutions.col(by_age(i));
  return {true, h.known};
}

void SubspaceGuess::accept(const SolvePosition& at, const VectorX& solution) {
  History& h = history(at);
  const bool again = h.last_step != at.step - 1 || (window_ == Window::restarted && h.known == size_);
  if (again) h.known = 0;
  h.newest = again ? 0 : (h.newest + 1) % size_;
  h.known = std::min(h.known + 1, size_);
  h.last_step = at.step;
  h.solutions.col(h.newest) = solution;
}

}  // namespace rodsweep
