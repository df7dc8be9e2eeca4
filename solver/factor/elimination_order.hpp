// Orders of elimination of the block rows of a matrix.
//
// An elimination couples all later neighbours of its row; pairs that the matrix does not couple are fill-in. Chains and
// trees have orders without fill-in (root_to_leaf_order() of block_factor.hpp). With loops there is none, and minimum
// degree keeps the fill-in low: the row with the fewest remaining neighbours comes next (Amestoy, Davis & Duff 1996;
// the approximate degrees are Eigen's).
#pragma once

#include <vector>

#include "solver/linear/block_matrix.hpp"

namespace rodsweep {

/// The rows as they are stored.
std::vector<int> given_order(const BlockMatrix& pattern);

/// The place of each row in an order.
std::vector<int> inverse(const std::vector<int>& order);

/// Whether elimination from the last to the first row of `order` has fill-in.
bool fills_in(const BlockMatrix& pattern, const std::vector<int>& order);

/// Block rows of the pattern, to be eliminated from the last to the first.
std::vector<int> minimum_degree_order(const BlockMatrix& pattern);

/// Nested dissection (George 1973): a small separator, without which two halves are not coupled, is eliminated last, and
/// each half is treated likewise. METIS finds the separators by multilevel bisection (Karypis & Kumar 1998) with a fixed
/// seed: the same pattern always has the same order. On lattices it has far less fill-in than minimum degree, a wide tree
/// and dense fronts. Empty if the library was built without METIS.
std::vector<int> nested_dissection_order(const BlockMatrix& pattern);

/// Block rows by their distance from a peripheral row (George & Liu 1979), rows of equal distance in the order of their
/// first neighbours (Cuthill & McKee 1969). Eliminated from the last to the first it is reverse Cuthill-McKee: a
/// complete factor has much fill-in, but an incomplete one (incomplete_factor.hpp) loses little.
std::vector<int> breadth_first_order(const BlockMatrix& pattern);

}  // namespace rodsweep
