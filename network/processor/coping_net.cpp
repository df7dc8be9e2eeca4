#include "network/processor/coping_net.hpp"

#include <stdexcept>

namespace rodsweep {

template <class T>
CopingNet<T>::CopingNet(const CopingNetSettings& settings, std::uint64_t seed) : settings_(settings) {
  WeightSource source(seed);
  const int nodes = node_features(settings), edges = edge_features(settings);
  if (settings.moves && settings.processor != Processor::message_passing)
    throw std::invalid_argument("CopingNet: moves need the processor message_passing");
  if (!is_guess(settings) && !settings.moves) throw std::invalid_argument("CopingNet: the encoding state needs moves");
  switch (settings.processor) {
    case Processor::factors:
      if (settings.encoding != Encoding::linear_system)
        throw std::invalid_argument("CopingNet: factors need the encoding linear_system");
      if (settings.couplings == Couplings::all)
        coupled_ = CoupledFactors<T>(parameters_, settings.latent, source);
      else
        factors_ = FactorSweeps<T>(parameters_, settings.latent, source);
      break;
    case Processor::message_passing:
      typename MessagePassing<T>::Sizes sizes;
      sizes.node_in = nodes;
      sizes.edge_in = edges;
      sizes.latent = settings.latent;
      sizes.steps = settings.steps;
      sizes.edge_out = is_guess(settings) ? 6 : 0;
      sizes.node_out = settings.moves ? 6 : 0;
      sizes.has_globals = settings.globals;
      sizes.hidden_layers = settings.hidden_layers;
      messages_ = MessagePassing<T>(parameters_, sizes, source);
  }
}

template <class T>
void CopingNet<T>::forward(const Topology& topology, const TensorIn<T>& nodes, const TensorIn<T>& edges, Tape& tape,
                           Tensor<T>& y_edges, Tensor<T>* y_nodes, const ScaledSystem<T>* systems) const {
  if (settings_.processor == Processor::message_passing) {
    messages_.forward(parameters_, topology.graph, nodes, edges, tape.messages, y_edges, y_nodes);
    return;
  }
  if (has_all_couplings(settings_)) return coupled_.forward(parameters_, *systems, tape.coupled, y_edges);
  tape.ordered.resize(edges.rows(), edges.cols());
  for (Eigen::Index i = 0; i < edges.cols(); ++i)
    tape.ordered.col(i) = edges.col(topology.forest.order[static_cast<std::size_t>(i)]);
  factors_.forward(parameters_, topology.forest, tape.ordered, tape.factors, tape.y_ordered);
  y_edges.resize(6, edges.cols());
  for (Eigen::Index i = 0; i < edges.cols(); ++i)
    y_edges.col(topology.forest.order[static_cast<std::size_t>(i)]) = tape.y_ordered.col(i);
}

template <class T>
void CopingNet<T>::backward(const Topology& topology, const TensorIn<T>& nodes, const TensorIn<T>& edges, Tape& tape,
                            const TensorIn<T>& dy_edges, const Tensor<T>* dy_nodes, Parameters<T>& gradient,
                            const ScaledSystem<T>* systems) const {
  if (settings_.processor == Processor::message_passing) {
    messages_.backward(parameters_, topology.graph, nodes, edges, tape.messages, dy_edges, dy_nodes, gradient);
    return;
  }
  if (has_all_couplings(settings_)) return coupled_.backward(parameters_, *systems, tape.coupled, dy_edges, gradient);
  tape.dy_ordered.resize(6, edges.cols());
  for (Eigen::Index i = 0; i < edges.cols(); ++i)
    tape.dy_ordered.col(i) = dy_edges.col(topology.forest.order[static_cast<std::size_t>(i)]);
  factors_.backward(parameters_, topology.forest, tape.ordered, tape.factors, tape.dy_ordered, gradient);
}

template class CopingNet<float>;
template class CopingNet<double>;

}  // namespace rodsweep
