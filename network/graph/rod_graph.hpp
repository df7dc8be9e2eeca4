// A rod as a graph for message passing: a node per segment, an edge per joint from its segment a (sender) to b
// (receiver). Loops are allowed. Several rods side by side are one graph whose parts stay contiguous.
#pragma once

#include <vector>

#include "solver/rod/rod.hpp"

namespace rodsweep {

struct RodGraph {
  int nodes = 0;
  std::vector<int> sender, receiver;  ///< node at each edge's ends
  std::vector<int> first_node{0, 0};  ///< of each rod, and the end
  std::vector<int> first_edge{0, 0};

  int edges() const { return static_cast<int>(sender.size()); }
  int rods() const { return static_cast<int>(first_node.size()) - 1; }
};

/// The graph of one rod.
RodGraph rod_graph(const Rod& rod);

/// Several graphs as one; nodes and edges are numbered consecutively.
RodGraph side_by_side(const std::vector<const RodGraph*>& graphs);

}  // namespace rodsweep
