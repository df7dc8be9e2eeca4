#include "network/training/example.hpp"

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
    systems.push_back(&one->system);
  }
  return {side_by_side(topologies),
          joined<T>(examples, &Example::nodes),
          joined<T>(examples, &Example::edges),
          side_by_side<T>(systems),
          joined<T>(examples, &Example::unit),
          joined<T>(examples, &Example::edge_target),
          joined<T>(examples, &Example::node_target)};
}

template Batch<float> make_batch<float>(const std::vector<const Example*>&);
template Batch<double> make_batch<double>(const std::vector<const Example*>&);

}  // namespace rodsweep
