#include "solver/guess/guarded_guess.hpp"

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

}  // namespace rodsweep
