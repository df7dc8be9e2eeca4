#include "solver/guess/totals_guess.hpp"

namespace rodsweep {

TotalsGuess::TotalsGuess(const Scene& scene, std::unique_ptr<InitialGuess> inner) : WrappedGuess(std::move(inner)) {
  for (const VectorX& none : unknowns_of(scene)) totals_.push_back({none});
}

void TotalsGuess::prepare(const SolvePosition& at) {
  Total& total = totals_[static_cast<std::size_t>(at.rod)];
  if (at.newton == 0 && !total.told) {
    inner_->accept_total(at.rod, total.step, total.sum);
    total.told = true;
  }
  inner_->prepare(at);
}

void TotalsGuess::accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) {
  inner_->accept(system, at, solution);
  Total& total = totals_[static_cast<std::size_t>(at.rod)];
  if (at.newton == 0) {
    total.sum = solution;
    total.step = at.step;
    total.told = false;
  } else if (total.step == at.step) {
    total.sum += solution;
  }
}

}  // namespace rodsweep
