// The topology of a rod's joints, or of several rods side by side, for every kind of processor.
//
// Edges (joints) are numbered by places: for one rod, the places of its JointForest; for several rods, rod after rod.
#pragma once

#include "network/graph/joint_forest.hpp"
#include "network/graph/rod_graph.hpp"

namespace rodsweep {

struct Topology {
  RodGraph graph;          ///< an edge per place
  JointForest forest;      ///< levels of places: forest.order[i] is a place
  std::vector<int> joint;  ///< the joint at each place, for one rod only
};

Topology topology(const Rod& rod);
Topology side_by_side(const std::vector<const Topology*>& rods);

}  // namespace rodsweep
