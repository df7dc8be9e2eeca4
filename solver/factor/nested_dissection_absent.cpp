#include "solver/factor/nested_dissection.hpp"

namespace rodsweep {

std::vector<int> nested_dissection_order(const BlockMatrix&) { return {}; }

}  // namespace rodsweep
