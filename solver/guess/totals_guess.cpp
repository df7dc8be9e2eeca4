#include "solver/guess/totals_guess.hpp"

namespace rodsweep {

TotalsGuess::TotalsGuess(const Scene& scene, std::unique_ptr<InitialGuess> inner) : inner_(std::move(inner)) {
  for (const Rod& rod : scene.rods) totals_.push_back({VectorX::Zero(6 * rod.joint_count())});
}

void TotalsGuess::prepare(const SolvePosition& at) {
  Total& total = totals_[static_cast<std::size_t>(at.rod)];
  if (at.newton == 0 && !total.told) {
    inner_->accept({total.step, 0, at.rod}, total.sum);
    total.told = true;
  }
  inner_->prepare(at);
}

void TotalsGuess::accept(const SolvePosition& at, const VectorX& solution) {
  Total& total = totals_[static_cast<std::size_t>(at.rod)];
  if (at.newton == 0) {
    total.sum = solution;
    total.step = at.step;
    total.told = false;
    return;
  }
  if (total.step == at.step) total.sum += solution;
  inner_->accept(at, solution);
}

}  // namespace rodsweep
