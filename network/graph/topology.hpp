// The topology of a rod's joints, or of several rods side by side, for every kind of processor.
//
// Edges (joints) are numbered by places: of one rod, the places of its JointForest; of several, those of one rod after
// those of the other.
#pragma once

#include "network/graph/joint_forest.hpp"
#include "network/graph/rod_graph.hpp"

namespace rodsweep {

struct Topology {
  RodGraph graph;          ///< an edge per place
  JointForest forest;      ///< levels of places: forest.order[i] is a place
  std::vector<int> joint;  ///< of one rod: the joint at each place
};

Topology topology(const Rod& rod);
Topology side_by_side(const std::vector<const Topology*>& rods);

}  // namespace rodsweep
