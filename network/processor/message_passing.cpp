#include "network/processor/message_passing.hpp"

namespace rodsweep {

template <class T>
MessagePassing<T>::MessagePassing(Parameters<T>& parameters, const Sizes& sizes, WeightSource& source)
    : sizes_(sizes),
      encode_nodes_(parameters, "encode_nodes", sizes.node_in, sizes.latent, sizes.latent, source, 1,
                    sizes.hidden_layers),
      encode_edges_(parameters, "encode_edges", sizes.edge_in, sizes.latent, sizes.latent, source, 1,
                    sizes.hidden_layers) {
  blocks_.resize(static_cast<std::size_t>(sizes.steps));
  for (std::size_t k = 0; k < blocks_.size(); ++k)
    blocks_[k] = GraphBlock<T>(parameters, "step_" + std::to_string(k), sizes.latent, sizes.hidden_layers,
                               updates(k, sizes.node_out > 0), sizes.has_globals && k > 0, source);
  if (sizes.edge_out > 0)
    decode_edges_ = Mlp<T>(parameters, "decode_edges", sizes.latent, sizes.latent, sizes.edge_out, source, 0.1,
                           sizes.hidden_layers);
  if (sizes.node_out > 0)
    decode_nodes_ = Mlp<T>(parameters, "decode_nodes", sizes.latent, sizes.latent, sizes.node_out, source, 0.1,
                           sizes.hidden_layers);
}

/// The last step updates nodes only if they are decoded, and never updates globals.
template <class T>
Updates MessagePassing<T>::updates(std::size_t step, bool nodes) const {
  if (step + 1 == blocks_.size()) return nodes ? Updates::nodes : Updates::edges;
  return sizes_.has_globals ? Updates::globals : Updates::nodes;
}

template <class T>
void MessagePassing<T>::forward(const Parameters<T>& p, const RodGraph& graph, const TensorIn<T>& x_nodes,
                                const TensorIn<T>& x_edges, Tape& tape, Tensor<T>& y_edges, Tensor<T>* y_nodes) const {
  tape.states.resize(blocks_.size() + 1);
  tape.blocks.resize(blocks_.size());
  encode_nodes_.forward(p, x_nodes, tape.encode_nodes, tape.states[0].nodes);
  encode_edges_.forward(p, x_edges, tape.encode_edges, tape.states[0].edges);
  for (std::size_t k = 0; k < blocks_.size(); ++k)
    blocks_[k].forward(p, graph, tape.states[k], updates(k, y_nodes), tape.blocks[k], tape.states[k + 1]);
  if (sizes_.edge_out > 0)
    decode_edges_.forward(p, tape.states.back().edges, tape.decode_edges, y_edges);
  else
    y_edges.resize(0, graph.edges());
  if (y_nodes) decode_nodes_.forward(p, tape.states.back().nodes, tape.decode_nodes, *y_nodes);
}

template <class T>
void MessagePassing<T>::backward(const Parameters<T>& p, const RodGraph& graph, const TensorIn<T>& x_nodes,
                                 const TensorIn<T>& x_edges, const Tape& tape, const TensorIn<T>& dy_edges,
                                 const Tensor<T>* dy_nodes, Parameters<T>& gradient) const {
  GraphState<T> d;
  d.nodes.setZero(sizes_.latent, graph.nodes);
  d.edges.setZero(sizes_.latent, graph.edges());
  if (sizes_.has_globals) d.globals.setZero(sizes_.latent, graph.rods());
  if (dy_nodes) decode_nodes_.backward(p, tape.states.back().nodes, tape.decode_nodes, *dy_nodes, gradient, &d.nodes);
  if (sizes_.edge_out > 0)
    decode_edges_.backward(p, tape.states.back().edges, tape.decode_edges, dy_edges, gradient, &d.edges);
  for (std::size_t k = blocks_.size(); k-- > 0;)
    blocks_[k].backward(p, graph, tape.states[k], updates(k, dy_nodes), tape.blocks[k], d, gradient);
  encode_edges_.backward(p, x_edges, tape.encode_edges, d.edges, gradient, nullptr);
  encode_nodes_.backward(p, x_nodes, tape.encode_nodes, d.nodes, gradient, nullptr);
}

template class MessagePassing<float>;
template class MessagePassing<double>;

}  // namespace rodsweep
