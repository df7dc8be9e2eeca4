#include "solver/factor/elimination_plan.hpp"

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include "solver/factor/elimination_order.hpp"

namespace rodsweep {
namespace {

// Measured on nets and lattices, in flops of the fronts' dense kernels: the cost of a flop of block-by-block
// elimination, and the cost of a block of L in fronts besides its flops.
constexpr double flop_of_single_blocks = 2.2, block_of_fronts = 8000;

double cost_in_fronts(const EliminationTree& tree) {
  return tree.flops() + block_of_fronts * static_cast<double>(tree.blocks());
}

/// Blocks on and below the diagonal.
std::int64_t lower_blocks(const BlockMatrix& pattern) { return (pattern.block_count() + pattern.block_rows()) / 2; }

std::string gibibytes(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g GiB", bytes / (1024.0 * 1024 * 1024));
  return text;
}

}  // namespace

EliminationPlan plan_elimination(const BlockMatrix& pattern, const std::vector<int>& preferred) {
  const auto blocks = static_cast<double>(lower_blocks(pattern));
  if (!fills_in(pattern, preferred)) return {preferred, {}, 0, sizeof(Block6) * blocks};
  EliminationPlan plan{minimum_degree_order(pattern)};
  EliminationTree tree = elimination_tree(pattern, plan.order);
  const double one_by_one = flop_of_single_blocks * tree.flops();
  if (one_by_one > block_of_fronts * blocks) {  // no order has fewer blocks
    const std::vector<int> dissection = nested_dissection_order(pattern);
    if (EliminationTree other = dissection.empty() ? tree : elimination_tree(pattern, dissection);
        cost_in_fronts(other) < std::min(cost_in_fronts(tree), one_by_one)) {
      tree = std::move(other);
      plan.order = dissection;
    }
    if (cost_in_fronts(tree) < one_by_one) plan.fronts.emplace(tree);
  }
  plan.fill_in = tree.blocks() - lower_blocks(pattern);
  plan.bytes = plan.fronts ? plan.fronts->bytes() : sizeof(Block6) * static_cast<double>(tree.blocks());
  plan.cost = plan.fronts ? cost_in_fronts(tree) : one_by_one;
  return plan;
}

FactorTooLarge::FactorTooLarge(int rows, double needed, double most)
    : std::runtime_error("a direct solve of " + std::to_string(rows) + " joints needs " + gibibytes(needed) +
                         " for its factor; the limit is " + gibibytes(most)) {}

void refuse_too_large(const EliminationPlan& plan, double most_bytes) {
  if (plan.bytes > most_bytes) throw FactorTooLarge(static_cast<int>(plan.order.size()), plan.bytes, most_bytes);
}

}  // namespace rodsweep
