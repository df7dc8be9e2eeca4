#include "solver/factor/condensed_factor.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "solver/factor/elimination_order.hpp"

namespace rodsweep {
namespace {

constexpr double most_contrast = 1e6;                 ///< of compliances
constexpr double accurate = 1e-12, rounding = 1e-15;  ///< shares of |b| and of a |d|
constexpr double cost_of_joint = 12000;  ///< measured on lattices and nets, in flops of the fronts' kernels

}  // namespace

bool can_be_condensed(const Rod& rod) {
  double smallest = std::numeric_limits<double>::infinity(), largest = 0;
  for (const Joint& joint : rod.joints) {
    smallest = std::min(smallest, joint.compliance.minCoeff());
    largest = std::max(largest, joint.compliance.maxCoeff());
  }
  return smallest > 0 && largest <= most_contrast * smallest;
}

EliminationPlan plan_crossings(const Condensation& condensation) {
  return plan_elimination(condensation.matrix(), given_order(condensation.matrix()));
}

double cost_of_condensing(const Rod& rod) { return cost_of_joint * rod.joint_count(); }

CondensedFactor::CondensedFactor(Condensation condensation, EliminationPlan plan)
    : condensation_(std::move(condensation)), factor_(condensation_.matrix(), std::move(plan)) {}

bool CondensedFactor::solve(const Rod& rod, const LinearSystem& system, VectorX& d) {
  corrections_ = 0;
  if (!factorise(rod, system)) return false;
  const VectorX& b = system.rhs();
  const double goal = accurate * b.norm();
  residual_.resize(b.size());
  correction_.resize(b.size());
  solve(b, d);
  while (true) {
    system.multiply(d.data(), residual_.data());
    residual_ = b - residual_;
    const double left = residual_.norm();
    if (left <= goal) return true;
    if (corrections_ > 0 && left <= rounding * largest_diagonal_entry(system.matrix()) * d.norm()) return true;
    if (corrections_ == most_corrections) return false;
    solve(residual_, correction_);
    d += correction_;
    ++corrections_;
  }
}

bool CondensedFactor::factorise(const Rod& rod, const LinearSystem& system) {
  return condensation_.assemble(rod, system.linearization(), system.dt()) && factor_.factorise(condensation_.matrix());
}

void CondensedFactor::substitute(VectorX& x) {
  residual_ = x;
  solve(residual_, x);
}

void CondensedFactor::load(int segment, const Lane8 (&force)[6]) {
  condensation_.load(segment, force, loaded_);
  factor_.substitute(loaded_);
}

void CondensedFactor::solve(const VectorX& r, VectorX& d) {
  condensation_.condense(r, crossings_);
  factor_.substitute(crossings_);
  condensation_.expand(r, crossings_.data(), d);
}

}  // namespace rodsweep
