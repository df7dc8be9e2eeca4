// In which order the block rows of a matrix are best eliminated.
//
// An elimination couples all later neighbours of its row; a pair that the matrix does not couple fills in. Chains and
// trees have orders without fill (root_to_leaf_order() of block_factor.hpp). Where joints close loops there is none,
// and minimum degree keeps the fill low: the row with the fewest neighbours left comes next (Amestoy, Davis & Duff
// 1996, whose approximate degrees are Eigen's).
#pragma once

#include <vector>

#include "solver/linear/block_matrix.hpp"

namespace rodsweep {

/// Does elimination from the last to the first row of `order` fill anything in?
bool fills_in(const BlockMatrix& pattern, const std::vector<int>& order);

/// Block rows of the pattern, to be eliminated from the last to the first.
std::vector<int> minimum_degree_order(const BlockMatrix& pattern);

/// Block rows by their distance from one at the rim, and of equal distance after the neighbours that were found first
/// (Cuthill & McKee 1969; the rim as George & Liu 1979 find it). Eliminated from the last to the first it is reverse
/// Cuthill-McKee: much fill in a complete factor, but an incomplete one (incomplete_factor.hpp) loses little by it.
std::vector<int> breadth_first_order(const BlockMatrix& pattern);

}  // namespace rodsweep
