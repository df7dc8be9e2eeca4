#include "solver/guess/subspace_guess.hpp"

#include <algorithm>

namespace rodsweep {

SubspaceGuess::SubspaceGuess(const Scene& scene, int newton_iterations, int size, Window window, Use use)
    : newton_iterations_(newton_iterations),
      size_(size),
      window_(window),
      order_(Eigen::VectorXi::Zero(size)),
      projection_(size) {
  for (const Rod& rod : scene.rods) {
    const StoredVectors none(6 * rod.joint_count(), size);
    histories_.insert(histories_.end(), at(newton_iterations), History{none});
    if (use == Use::guess_and_deflation) products_.push_back(none);
  }
}

SubspaceGuess::History& SubspaceGuess::history(const SolvePosition& at) {
  return histories_[static_cast<std::size_t>(at.rod * newton_iterations_ + at.newton)];
}

Proposal SubspaceGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  History& h = history(at);
  deflating_ = false;
  if (h.last_step != at.step - 1 || h.known == 0) {
    x0.setZero();
    return {};
  }
  for (int age = 0; age < h.known; ++age) order_[age] = (h.newest - age + size_) % size_;
  projection_.project(system.matrix(), system.rhs(), h.solutions, order_, h.known, x0);
  if (!products_.empty()) {
    deflating_ = true;
    projection_.deflate(system.matrix(), h.solutions, products_[static_cast<std::size_t>(at.rod)]);
  }
  return {true, h.known};
}

void SubspaceGuess::accept(const LinearSystem&, const SolvePosition& at, const VectorX& solution) {
  History& h = history(at);
  const bool again = h.last_step != at.step - 1 || (window_ == Window::restarted && h.known == size_);
  if (again) h.known = 0;
  h.newest = again ? 0 : (h.newest + 1) % size_;
  h.known = std::min(h.known + 1, size_);
  h.last_step = at.step;
  h.solutions.set(h.newest, solution);
}

void SubspaceGuess::accept_total(int rod, int step, const VectorX& total) {
  History& h = history({step, 0, rod});
  if (h.last_step == step) h.solutions.set(h.newest, total);
}

}  // namespace rodsweep
