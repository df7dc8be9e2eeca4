// The cheapest factorisation of a matrix and its cost, before any memory is allocated.
//
// An order without fill-in is kept: chains and trees. Otherwise minimum degree (elimination_order.hpp) and nested
// dissection are compared by the cost that the elimination tree gives (elimination_tree.hpp).
// With little fill-in blocks are eliminated one by one in the order of minimum degree; dense fronts in the cheaper
// order are used if they are expected to be faster.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <vector>

#include "solver/factor/assembly_tree.hpp"
#include "solver/linear/block_matrix.hpp"

namespace rodsweep {

/// Memory limit of one factor: about the share of a core on a cluster. A lattice of 100,000 joints needs half of it.
inline constexpr double most_factor_bytes = 4.0 * 1024 * 1024 * 1024;

struct EliminationPlan {
  std::vector<int> order;                ///< block rows, eliminated from the last to the first
  std::optional<AssemblyTree> fronts{};  ///< empty: blocks one by one
  std::int64_t fill_in = 0;              ///< blocks of L that A does not have
  double bytes = 0;                      ///< of the factor
  double cost = 0;                       ///< of a factorisation, in flops of the fronts' kernels; 0 without fill
};

EliminationPlan plan_elimination(const BlockMatrix& pattern, const std::vector<int>& preferred);

/// A factor would need more memory than allowed.
struct FactorTooLarge : std::runtime_error {
  FactorTooLarge(int block_rows, double bytes, double most_bytes);
};

/// Throws FactorTooLarge if the factor needs more than `most_bytes`.
void refuse_too_large(const EliminationPlan& plan, double most_bytes = most_factor_bytes);

}  // namespace rodsweep
