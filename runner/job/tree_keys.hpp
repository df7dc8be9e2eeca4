// The keys that only scenes of trees have, and what they describe.
#pragma once

#include <vector>

#include "runner/job/key.hpp"
#include "runner/job/sweep_space.hpp"
#include "solver/scene/tree_skeleton.hpp"

namespace rodsweep {

std::vector<Key> tree_keys();

/// Of a "tree" or "forest" at a parameter point.
TreeShape tree_shape(const Point& point);

}  // namespace rodsweep
