#include "solver/factor/block_factor.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

namespace rodsweep {
namespace {

/// A matrix of more joints exceeds the cache. Memory is read fastest along the rod: branch after branch.
constexpr int most_in_cache = 4096;

std::variant<BlockElimination, MultifrontalFactor> factor_of(const BlockMatrix& pattern, EliminationPlan plan) {
  refuse_too_large(plan);
  if (plan.fronts) return MultifrontalFactor(pattern, std::move(*plan.fronts));
  return BlockElimination(pattern, plan.order);
}

}  // namespace

std::vector<int> root_to_leaf_order(const Rod& rod) {
  const std::vector<std::vector<JointEnd>> joints_of = joints_by_segment(rod);
  std::vector<std::size_t> left(rod.segments.size());  // joints of a segment that are not eliminated
  for (std::size_t s = 0; s < left.size(); ++s) left[s] = joints_of[s].size();
  std::deque<int> free;  // joints that can be eliminated now
  std::vector<bool> seen(rod.joints.size(), false);
  const auto see = [&](int k) {
    if (!seen[at(k)]) free.push_back(k);
    seen[at(k)] = true;
  };
  const auto see_all_of = [&](std::size_t s) {
    for (const JointEnd& end : joints_of[s]) see(end.joint);
  };
  for (std::size_t s = 0; s < left.size(); ++s)
    if (left[s] == 1 || rod.segments[s].is_static) see_all_of(s);
  std::vector<int> order;  // of elimination
  const auto eliminate_free = [&] {
    while (!free.empty()) {
      const int k = rod.joint_count() > most_in_cache ? free.back() : free.front();
      rod.joint_count() > most_in_cache ? free.pop_back() : free.pop_front();
      order.push_back(k);
      const Joint& joint = rod.joints[at(k)];
      for (const int s : {joint.a, joint.b})
        if (--left[at(s)] == 1) see_all_of(at(s));
    }
  };
  eliminate_free();
  for (int k = 0; k < rod.joint_count(); ++k) see(k);  // joints of loops, and between loops
  eliminate_free();
  std::reverse(order.begin(), order.end());
  return order;
}

BlockFactor::BlockFactor(const BlockMatrix& pattern, const std::vector<int>& preferred)
    : BlockFactor(pattern, plan_elimination(pattern, preferred)) {}

BlockFactor::BlockFactor(const BlockMatrix& pattern, EliminationPlan plan)
    : factor_(factor_of(pattern, plan)), fill_in_(static_cast<int>(plan.fill_in)) {}

SolveOutcome BlockFactor::solve(const BlockMatrix& a, const VectorX& b, VectorX& x) {
  if (auto* const blocks = std::get_if<BlockElimination>(&factor_)) return blocks->solve(a, b, x);
  if (!factorise(a)) return SolveOutcome::indefinite;
  x = b;
  substitute(x);
  return std::isfinite(x.sum()) ? SolveOutcome::converged : SolveOutcome::not_a_number;
}

bool BlockFactor::factorise(const BlockMatrix& a) {
  return std::visit([&](auto& factor) { return factor.factorise(a); }, factor_);
}

void BlockFactor::substitute(VectorX& x) {
  std::visit([&](auto& factor) { factor.substitute(x); }, factor_);
}

void BlockFactor::substitute(std::vector<Lane8>& x) {
  std::visit([&](auto& factor) { factor.substitute(x); }, factor_);
}

}  // namespace rodsweep
