#include "network/graph/topology.hpp"

namespace rodsweep {

Topology topology(const Rod& rod) {
  Topology out;
  out.graph = rod_graph(rod);
  const JointForest forest = joint_forest(rod);
  out.joint = forest.order;
  out.forest = side_by_side(std::vector<const JointForest*>{&forest});
  const RodGraph by_joint = out.graph;
  for (std::size_t i = 0; i < out.joint.size(); ++i) {
    const auto j = static_cast<std::size_t>(out.joint[i]);
    out.graph.sender[i] = by_joint.sender[j];
    out.graph.receiver[i] = by_joint.receiver[j];
  }
  return out;
}

Topology side_by_side(const std::vector<const Topology*>& rods) {
  std::vector<const RodGraph*> graphs;
  std::vector<const JointForest*> forests;
  for (const Topology* rod : rods) {
    graphs.push_back(&rod->graph);
    forests.push_back(&rod->forest);
  }
  Topology out;
  out.graph = side_by_side(graphs);
  out.forest = side_by_side(forests);
  return out;
}

}  // namespace rodsweep
