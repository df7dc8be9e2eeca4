// Inference on one rod asks for no memory after the first time: not in its features, not in its layers.
#include <catch2/catch.hpp>

#include "allocations.hpp"
#include "network/graph_encoding.hpp"
#include "network/message_passing.hpp"
#include "network/normalisation.hpp"
#include "support.hpp"

namespace rodsweep {
namespace {

TEST_CASE("encoding, normalisation and message passing allocate nothing on a rod seen before") {
  const auto encoding = GENERATE(Encoding::deck, Encoding::physics);
  const bool has_globals = GENERATE(false, true);
  const int segments = GENERATE(50, 400);
  CAPTURE(has_globals, segments);
  const Scene scene = build_scene(test::bending_rod(segments));
  const Rod& rod = scene.rods.front();
  LinearSystem system(rod);
  const GraphEncoding encode(encoding, rod);
  const RodGraph graph = rod_graph(rod);
  Parameters<float> p;
  WeightSource source(1);
  const int node_in = GraphEncoding::node_features(encoding), edge_in = GraphEncoding::edge_features(encoding);
  const MessagePassing<float> net(p, {node_in, edge_in, 64, 3, 6, 6, has_globals}, source);
  const Normalisation of_nodes{Eigen::ArrayXf::Zero(node_in), Eigen::ArrayXf::Ones(node_in)};
  const Normalisation of_edges{Eigen::ArrayXf::Zero(edge_in), Eigen::ArrayXf::Ones(edge_in)};
  Tensor<float> x_nodes(node_in, graph.nodes), x_edges(edge_in, graph.edges()), y_edges, y_nodes;
  MessagePassing<float>::Tape tape;
  long before = 0;
  for (int solve = 0; solve < 3; ++solve) {
    if (solve == 1) before = test::allocations();
    system.assemble(rod, 0.02);
    encode.encode(rod, system, 0, 0.02, x_nodes, x_edges);
    of_nodes.apply(x_nodes);
    of_edges.apply(x_edges);
    net.forward(p, graph, x_nodes, x_edges, tape, y_edges, solve == 1 ? nullptr : &y_nodes);
  }
  CHECK(before > 0);
  CHECK(test::allocations() == before);
}

}  // namespace
}  // namespace rodsweep
