// One linear system as a training example, and mini-batches of examples.
//
// The network's output y, [6, places], represents the correction d^ = unit * y of the scaled system (entry by entry;
// network/encoding/scaled_system.hpp). Everything per joint is in the places of the topology.
#pragma once

#include <memory>
#include <vector>

#include "network/encoding/scaled_system.hpp"
#include "network/graph/topology.hpp"

namespace rodsweep {

struct Example {
  std::shared_ptr<const Topology> topology;
  Tensor<float> nodes, edges;  ///< features [node features, segments], [edge features, places]; edges is empty
                               ///< if system_features(system) gives them
  ScaledSystem<float> system;  ///< without places for `state`
  Tensor<float> unit;          ///< [6, places]; empty: ones
  Tensor<float> edge_target;   ///< [6, places]: the exact y
  Tensor<float> node_target;   ///< [6, segments]: the moves Delta p in the network's units, or empty
};

template <class T>
struct Batch {
  Topology topology;
  Tensor<T> nodes, edges;
  ScaledSystem<T> systems;
  Tensor<T> unit, edge_target, node_target;
};

template <class T>
Batch<T> make_batch(const std::vector<const Example*>& examples);

}  // namespace rodsweep
