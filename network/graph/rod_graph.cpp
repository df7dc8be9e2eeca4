#include "network/graph/rod_graph.hpp"

namespace rodsweep {

RodGraph rod_graph(const Rod& rod) {
  RodGraph out;
  out.nodes = rod.segment_count();
  for (const Joint& joint : rod.joints) {
    out.sender.push_back(joint.a);
    out.receiver.push_back(joint.b);
  }
  out.first_node = {0, out.nodes};
  out.first_edge = {0, out.edges()};
  return out;
}

RodGraph side_by_side(const std::vector<const RodGraph*>& graphs) {
  RodGraph out;
  out.first_node = {0};
  out.first_edge = {0};
  for (const RodGraph* graph : graphs) {
    const int nodes = out.nodes, edges = out.edges();
    for (const int node : graph->sender) out.sender.push_back(nodes + node);
    for (const int node : graph->receiver) out.receiver.push_back(nodes + node);
    for (int rod = 1; rod <= graph->rods(); ++rod) {
      out.first_node.push_back(nodes + graph->first_node[static_cast<std::size_t>(rod)]);
      out.first_edge.push_back(edges + graph->first_edge[static_cast<std::size_t>(rod)]);
    }
    out.nodes += graph->nodes;
  }
  return out;
}

}  // namespace rodsweep
