#include "solver/factor/direct_factor.hpp"

#include <utility>

namespace rodsweep {
namespace {

constexpr double clearly_cheaper = 0.8;  ///< costs are known to a tenth, and a correction may be needed

std::optional<CondensedFactor> condensed(const Rod& rod, double cost_of_whole) {
  const double most = clearly_cheaper * cost_of_whole - cost_of_condensing(rod);
  if (most <= 0 || !can_be_condensed(rod)) return {};
  Condensation condensation(rod);
  EliminationPlan plan = plan_crossings(condensation);
  if (plan.cost >= most) return {};
  return CondensedFactor(std::move(condensation), std::move(plan));
}

}  // namespace

DirectFactor::DirectFactor(const Rod& rod) {
  const LinearSystem system(rod);
  const BlockMatrix& pattern = system.matrix();
  EliminationPlan plan = plan_elimination(pattern, root_to_leaf_order(rod));
  refuse_too_large(plan);
  condensed_ = condensed(rod, plan.cost);
  if (!condensed_) whole_.emplace(pattern, std::move(plan));
}

SolveOutcome DirectFactor::solve(const Rod& rod, const LinearSystem& system, VectorX& x) {
  if (condensed_ && condensed_->solve(rod, system, x)) return SolveOutcome::converged;
  if (!whole_) whole_.emplace(system.matrix(), root_to_leaf_order(rod));
  return whole_->solve(system.matrix(), system.rhs(), x);
}

bool DirectFactor::factorise(const Rod& rod, const LinearSystem& system) {
  is_condensed_ = condensed_ && condensed_->factorise(rod, system);
  if (is_condensed_) return true;
  if (!whole_) whole_.emplace(system.matrix(), root_to_leaf_order(rod));
  return whole_->factorise(system.matrix());
}

void DirectFactor::substitute(VectorX& x) {
  if (is_condensed_)
    condensed_->substitute(x);
  else
    whole_->substitute(x);
}

}  // namespace rodsweep
