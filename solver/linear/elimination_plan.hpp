// How a matrix is best factorised, and what that takes, before any memory is asked for.
//
// An order without fill is taken as it is: chains and trees. One that fills in gives way to minimum degree
// (elimination_order.hpp) or nested dissection (nested_dissection.hpp), whichever costs less by the elimination tree
// (elimination_tree.hpp): blocks one by one in the first order where little fills in, dense fronts in the better one of
// both where they are expected to be faster.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <vector>

#include "solver/linear/assembly_tree.hpp"
#include "solver/linear/block_matrix.hpp"

namespace rodsweep {

/// What one factor may take: about what a core of a cluster has. A lattice of 100,000 joints needs half of it.
inline constexpr double most_factor_bytes = 4.0 * 1024 * 1024 * 1024;

struct EliminationPlan {
  std::vector<int> order;                ///< block rows, eliminated from the last to the first
  std::optional<AssemblyTree> fronts{};  ///< where it is done in fronts
  std::int64_t fill_in = 0;              ///< blocks of L that A does not have
  double bytes = 0;                      ///< of the factor
  double flops = 0;                      ///< of a factorisation; 0 without fill
};

EliminationPlan plan_elimination(const BlockMatrix& pattern, const std::vector<int>& preferred);

/// A factor would need more than it may have.
struct FactorTooLarge : std::runtime_error {
  FactorTooLarge(int block_rows, double bytes, double most_bytes);
  int block_rows;
  double bytes;
};

/// Throws FactorTooLarge.
void refuse_too_large(const EliminationPlan& plan, double most_bytes = most_factor_bytes);

}  // namespace rodsweep
