#include "solver/guess/wrapped_guess.hpp"

namespace rodsweep {

Proposal GuardedGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  const Proposal inner = inner_->propose(system, at, x0);
  used_ = true;
  if (!inner.nonzero) return inner;
  VectorX& residual = residual_[static_cast<std::size_t>(at.rod)];
  find_residual(system, inner, x0, residual);
  const int products = inner.start_products();
  const double limit = threshold_ * threshold_ * jacobi_norm_squared(system.matrix(), system.rhs());
  if (jacobi_norm_squared(system.matrix(), residual) < limit)
    return {true, products, &residual, inner.renewed, inner.with_network};
  used_ = false;  // the residual of zero is not orthogonal to the space of a deflation
  x0.setZero();
  return {false, products, nullptr, inner.renewed, inner.with_network};
}

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
