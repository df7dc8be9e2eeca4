#include "solver/factor/elimination_order.hpp"

namespace rodsweep {

std::vector<int> nested_dissection_order(const BlockMatrix&) { return {}; }

}  // namespace rodsweep
