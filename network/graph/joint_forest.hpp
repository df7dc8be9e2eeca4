// The joints of rods as a forest, for passes from the tips to the roots and back.
//
// A joint's parent is the next joint on the way to a static segment (or, if no segment is static, to the first joint of
// the first segment). Loops are cut: the joint that closes one is a tip. Joints are renumbered so that those of one
// depth are contiguous: one matrix product per level.
#pragma once

#include <vector>

#include "solver/rod/rod.hpp"

namespace rodsweep {

struct JointForest {
  std::vector<int> order;   ///< joint at each place (several rods: numbered consecutively); by depth, then as given
  std::vector<int> parent;  ///< place of each place's parent, -1 at a root
  std::vector<int> beside;  ///< per place, the number of joints that share a free segment with its joint,
                            ///< without parent and children: siblings, and joints that close a loop
  std::vector<int> level_begin;  ///< first place of each depth, and the end
  bool cut = false;              ///< whether loops were cut

  int size() const { return static_cast<int>(order.size()); }
  int levels() const { return static_cast<int>(level_begin.size()) - 1; }
};

/// The forest of one rod.
JointForest joint_forest(const Rod& rod);

/// Several forests as one, level by level.
JointForest side_by_side(const std::vector<const JointForest*>& forests);

}  // namespace rodsweep
