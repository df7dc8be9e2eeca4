// Message passing: gradients, receptive field of an output, independence of numbering and of graphs side by side.
#include <algorithm>
#include <numeric>

#include "network/processor/message_passing.hpp"
#include "tests/network/gradient_check.hpp"

namespace rodsweep::test_message_passing {

using namespace test;
using Net = MessagePassing<double>;

RodGraph graph_of(const Edges& edges, const std::vector<int>& held = {0}) {
  return rod_graph(random_rod(edges, held, 1));
}

/// A tree, a chain, a graph with loops, and a rod of one segment, side by side.
RodGraph some_graphs() {
  const RodGraph a = graph_of(tree(2, 3)), b = graph_of(chain(4)), c = graph_of(net(2, 3)), d = graph_of(chain(1));
  return side_by_side(std::vector<const RodGraph*>{&a, &b, &c, &d});
}

/// A network with nonzero biases, its inputs and outputs.
struct Case {
  RodGraph graph;
  Parameters<double> p;
  Net net;
  Matrix x_nodes, x_edges;
  Net::Tape tape;
  Matrix y_edges, y_nodes;

  Case(RodGraph g, int steps, int node_out, bool has_globals, int latent = 5, int hidden_layers = 1, int edge_out = 2)
      : graph(std::move(g)) {
    WeightSource source(7);
    net = Net(p, {3, 4, latent, steps, edge_out, node_out, has_globals, hidden_layers}, source);
    for (double& v : p.values()) v += 0.05;
    x_nodes = random_matrix(3, graph.nodes, 2);
    x_edges = random_matrix(4, graph.edges(), 3);
  }
  Parameters<double> gradient(const Matrix& d_edges, const Matrix* d_nodes) {
    Parameters<double> out = p.zeros();
    net.backward(p, graph, x_nodes, x_edges, tape, d_edges, d_nodes, out);
    return out;
  }
  void run() { net.forward(p, graph, x_nodes, x_edges, tape, y_edges, net.sizes().node_out > 0 ? &y_nodes : nullptr); }
};

TEST_CASE("the gradients of message passing are those of central differences") {
  for (const bool has_globals : {false, true})
    for (const int node_out : {0, 3})
      for (const int steps : {1, 3}) {
        const int hidden_layers = steps == 1 ? 3 : 1, edge_out = node_out > 0 && steps > 1 ? 0 : 2;
        CAPTURE(has_globals, node_out, steps, hidden_layers, edge_out);
        Case c(some_graphs(), steps, node_out, has_globals, 3, hidden_layers, edge_out);
        const Matrix d_edges = random_matrix(edge_out, c.graph.edges(), 4),
                     d_nodes = random_matrix(node_out, c.graph.nodes, 5);
        const auto loss = [&] {
          c.run();
          return c.y_edges.cwiseProduct(d_edges).sum() + (node_out ? c.y_nodes.cwiseProduct(d_nodes).sum() : 0);
        };
        loss();
        const Parameters<double> gradient = c.gradient(d_edges, node_out ? &d_nodes : nullptr);
        CHECK(gradient_error(c.p.values(), gradient.values(), loss) < 1e-7);
      }
}

TEST_CASE("every weight is used: none has a gradient of zero") {
  for (const bool has_globals : {false, true})
    for (const int node_out : {0, 3, 4}) {
      const int edge_out = node_out == 4 ? 0 : 2;
      CAPTURE(has_globals, node_out, edge_out);
      Case c(some_graphs(), 3, node_out, has_globals, 5, 2, edge_out);
      c.run();
      const Matrix d_edges = random_matrix(edge_out, c.graph.edges(), 4),
                   d_nodes = random_matrix(node_out, c.graph.nodes, 5);
      Parameters<double> gradient = c.gradient(d_edges, node_out ? &d_nodes : nullptr);
      for (std::size_t i = 0; i < c.p.entries().size(); ++i) {
        CAPTURE(c.p.entries()[i].name);
        CHECK(gradient[static_cast<int>(i)].cwiseAbs().minCoeff() > 0);
      }
    }
}

TEST_CASE("edge outputs don't depend on whether nodes are decoded beside them") {
  Case c(some_graphs(), 3, 2, true);
  c.run();
  Matrix alone;
  c.net.forward(c.p, c.graph, c.x_nodes, c.x_edges, c.tape, alone);
  CHECK((alone - c.y_edges).norm() < 1e-13);
  // A tape of a run with node outputs gives the same gradient of the edges.
  const Matrix d_edges = random_matrix(2, c.graph.edges(), 4), none = Matrix::Zero(2, c.graph.nodes);
  const Parameters<double> of_edges = c.gradient(d_edges, nullptr);
  c.run();
  const Parameters<double> of_both = c.gradient(d_edges, &none);
  for (std::size_t i = 0; i < of_edges.values().size(); ++i)
    CHECK(of_edges.values()[i] == Approx(of_both.values()[i]).margin(1e-13));
}

TEST_CASE("renumbering nodes and edges renumbers the outputs") {
  Case c(graph_of(net(3, 3)), 3, 2, true);
  std::vector<int> node(static_cast<std::size_t>(c.graph.nodes)), edge(static_cast<std::size_t>(c.graph.edges()));
  std::iota(node.begin(), node.end(), 0);  // maps old numbers to new ones
  std::iota(edge.begin(), edge.end(), 0);
  std::mt19937 engine(5);
  std::shuffle(node.begin(), node.end(), engine);
  std::shuffle(edge.begin(), edge.end(), engine);
  Case other = c;
  for (int i = 0; i < c.graph.nodes; ++i) other.x_nodes.col(node[i]) = c.x_nodes.col(i);
  for (int k = 0; k < c.graph.edges(); ++k) {
    const auto from = static_cast<std::size_t>(k), to = static_cast<std::size_t>(edge[from]);
    other.x_edges.col(edge[from]) = c.x_edges.col(k);
    other.graph.sender[to] = node[c.graph.sender[from]];
    other.graph.receiver[to] = node[c.graph.receiver[from]];
  }
  c.run();
  other.run();
  for (int i = 0; i < c.graph.nodes; ++i) CHECK((other.y_nodes.col(node[i]) - c.y_nodes.col(i)).norm() < 1e-13);
  for (int k = 0; k < c.graph.edges(); ++k) CHECK((other.y_edges.col(edge[k]) - c.y_edges.col(k)).norm() < 1e-13);
}

TEST_CASE("senders and receivers are told apart") {
  Case c(graph_of(chain(3)), 2, 0, false);
  Case turned = c;
  std::swap(turned.graph.sender[0], turned.graph.receiver[0]);
  c.run();
  turned.run();
  CHECK((c.y_edges.col(0) - turned.y_edges.col(0)).norm() > 1e-3);
  CHECK((c.y_edges.col(1) - turned.y_edges.col(1)).norm() > 1e-3);
}

TEST_CASE("a rod's outputs are the same alone and beside others, with a global state too") {
  const RodGraph a = graph_of(tree(2, 3)), b = graph_of(net(2, 3));
  Case both(side_by_side(std::vector<const RodGraph*>{&a, &b}), 3, 2, true), alone(b, 3, 2, true);
  alone.x_nodes = both.x_nodes.rightCols(b.nodes);
  alone.x_edges = both.x_edges.rightCols(b.edges());
  both.run();
  alone.run();
  CHECK((both.y_nodes.rightCols(b.nodes) - alone.y_nodes).norm() < 1e-13);
  CHECK((both.y_edges.rightCols(b.edges()) - alone.y_edges).norm() < 1e-13);
}

TEST_CASE("with K steps an output sees the nodes up to K hops away and no further, unless there is a global state") {
  constexpr int steps = 3, changed = 5;
  for (const bool has_globals : {false, true}) {
    CAPTURE(has_globals);
    Case c(graph_of(chain(12)), steps, 2, has_globals);
    c.run();
    const Matrix edges = c.y_edges, nodes = c.y_nodes;
    c.x_nodes(0, changed) += 1;
    c.run();
    for (int i = 0; i < 12; ++i)
      CHECK(((c.y_nodes.col(i) - nodes.col(i)).norm() > 0) == (has_globals || std::abs(i - changed) <= steps));
    for (int k = 0; k < 11; ++k) {  // edge k joins nodes k and k + 1
      const int hops = k < changed ? changed - k : k - changed + 1;
      CHECK(((c.y_edges.col(k) - edges.col(k)).norm() > 0) == (has_globals || hops <= steps));
    }
  }
}

}  // namespace rodsweep::test_message_passing
