#include "solver/guess/subspace_guess.hpp"

namespace rodsweep {

SubspaceGuess::SubspaceGuess(const Scene& scene, int newton_iterations, int size, Window window, Use use)
    : HistoryGuess(newton_iterations), window_(window), order_(Eigen::VectorXi::Zero(size)), projection_(size) {
  for (const Rod& rod : scene.rods) {
    const StoredVectors none(6 * rod.joint_count(), size);
    add_rod({{size}, none});
    if (use == Use::guess_and_deflation) products_.push_back(none);
  }
}

Proposal SubspaceGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  StoredSolutions& h = history(at);
  deflating_ = false;
  if (h.usable(at.step) == 0) {
    x0.setZero();
    return {};
  }
  h.put_order(order_);
  projection_.project(system.matrix(), system.rhs(), h.solutions, order_, h.known, x0);
  if (!products_.empty()) {
    deflating_ = true;
    projection_.deflate(system.matrix(), h.solutions, products_[static_cast<std::size_t>(at.rod)]);
  }
  return {true, h.known};
}

void SubspaceGuess::accept(const LinearSystem&, const SolvePosition& at, const VectorX& solution) {
  StoredSolutions& h = history(at);
  if (window_ == Window::restarted && h.known == h.size) h.known = 0;
  h.add(at.step);
  h.keep(solution);
}

}  // namespace rodsweep
