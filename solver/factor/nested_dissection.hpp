// Nested dissection (George 1973) of the block rows of a matrix: a small separator, without which two halves are not
// coupled, is eliminated last, and each half is treated likewise. METIS finds the separators by multilevel bisection
// (Karypis & Kumar 1998) with a fixed seed: the same pattern always has the same order.
//
// On lattices it has far less fill-in than minimum degree, a wide tree and dense fronts.
#pragma once

#include <vector>

#include "solver/linear/block_matrix.hpp"

namespace rodsweep {

/// Block rows, to be eliminated from the last to the first; empty if the library was built without METIS.
std::vector<int> nested_dissection_order(const BlockMatrix& pattern);

}  // namespace rodsweep
