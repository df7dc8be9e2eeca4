// A graph network over the segments and joints of rods, as encode-process-decode (Battaglia et al. 2018;
// Sanchez-Gonzalez et al. 2020):
//   encode    v = MLP(x_node), e = MLP(x_edge), u = 0      (a learned u would be one more bias)
//   process   K steps of GraphBlock, each with its own weights
//   decode    y_edge = MLP(e), y_node = MLP(v)
// The output of an edge depends on the nodes up to K hops away (its own ends are one hop away); a node's output
// likewise.
// With a global state it depends on the whole rod from the second step on.
#pragma once

#include "network/processor/graph_block.hpp"

namespace rodsweep {

template <class T>
class MessagePassing {
 public:
  struct Sizes {
    int node_in = 0, edge_in = 0, latent = 0, steps = 1;
    int edge_out = 0, node_out = 0;  ///< 0: no decoder
    bool has_globals = false;
    int hidden_layers = 1;  ///< of every MLP
  };
  /// What backward() needs of forward(); reused from batch to batch.
  struct Tape {
    std::vector<GraphState<T>> states;  ///< before, between and after the steps
    std::vector<typename GraphBlock<T>::Tape> blocks;
    typename Mlp<T>::Tape encode_nodes, encode_edges, decode_nodes, decode_edges;
  };

  MessagePassing() = default;
  MessagePassing(Parameters<T>& parameters, const Sizes& sizes, WeightSource& source);
  const Sizes& sizes() const { return sizes_; }

  /// x_nodes [node_in, nodes], x_edges [edge_in, edges]; sets y_edges [edge_out, edges] and, if given, y_nodes
  /// [node_out, nodes]; without y_nodes the last node update is skipped. Allocates nothing for a graph of the last
  /// size.
  void forward(const Parameters<T>& p, const RodGraph& graph, const TensorIn<T>& x_nodes, const TensorIn<T>& x_edges,
               Tape& tape, Tensor<T>& y_edges, Tensor<T>* y_nodes = nullptr) const;
  /// Adds to `gradient`; dy_nodes is given if forward() had y_nodes. Derivatives of inputs are not computed.
  void backward(const Parameters<T>& p, const RodGraph& graph, const TensorIn<T>& x_nodes, const TensorIn<T>& x_edges,
                const Tape& tape, const TensorIn<T>& dy_edges, const Tensor<T>* dy_nodes,
                Parameters<T>& gradient) const;

 private:
  Updates updates(std::size_t step, bool nodes) const;

  Sizes sizes_;
  Mlp<T> encode_nodes_, encode_edges_, decode_nodes_, decode_edges_;
  std::vector<GraphBlock<T>> blocks_;
};

}  // namespace rodsweep
