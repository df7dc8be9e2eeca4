#include "network/training/example.hpp"

#include "network/encoding/system_encoding.hpp"

namespace rodsweep {
namespace {

/// The columns of one member of all examples, side by side.
template <class T>
Tensor<T> joined(const std::vector<const Example*>& examples, Tensor<float> Example::*member) {
  Eigen::Index columns = 0;
  for (const Example* one : examples) columns += (one->*member).cols();
  Tensor<T> out((examples.front()->*member).rows(), columns);
  Eigen::Index first = 0;
  for (const Example* one : examples) {
    const Tensor<float>& part = one->*member;
    out.middleCols(first, part.cols()) = part.cast<T>();
    first += part.cols();
  }
  return out;
}

}  // namespace

template <class T>
Batch<T> make_batch(const std::vector<const Example*>& examples) {
  std::vector<const Topology*> topologies;
  std::vector<const ScaledSystem<float>*> systems;
  for (const Example* one : examples) {
    topologies.push_back(one->topology.get());
    if (one->system.diagonal.cols() > 0) systems.push_back(&one->system);  // `state` has none
  }
  const Example& first = *examples.front();
  Batch<T> out;
  out.topology = side_by_side(topologies);
  out.systems = side_by_side<T>(systems);
  out.nodes = joined<T>(examples, &Example::nodes);
  out.edges = first.edges.size() > 0 ? joined<T>(examples, &Example::edges)
                                     : system_features<T>(out.systems, out.topology.forest);
  out.unit = first.unit.size() > 0 ? joined<T>(examples, &Example::unit) : Tensor<T>::Ones(6, out.edges.cols());
  out.edge_target = joined<T>(examples, &Example::edge_target);
  out.node_target = joined<T>(examples, &Example::node_target);
  return out;
}

template Batch<float> make_batch<float>(const std::vector<const Example*>&);
template Batch<double> make_batch<double>(const std::vector<const Example*>&);

}  // namespace rodsweep
