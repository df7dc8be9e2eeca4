// Nested dissection (George 1973) of the block rows of a matrix: a small set of rows whose removal leaves two halves
// that are not coupled is eliminated last, and so on within the halves. Separators are those of METIS's multilevel
// bisection (Karypis & Kumar 1998), from a fixed seed: the same pattern has the same order every time.
//
// On lattices the fill is far below that of minimum degree, the tree wide and its fronts dense.
#pragma once

#include <vector>

#include "solver/linear/block_matrix.hpp"

namespace rodsweep {

/// Block rows, to be eliminated from the last to the first; empty where the library was built without METIS.
std::vector<int> nested_dissection_order(const BlockMatrix& pattern);

}  // namespace rodsweep
