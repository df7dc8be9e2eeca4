// COPINGNet maps features of segments and joints to corrections of the Lagrange multipliers and, on request, moves of
// the segments; for `state` to moves only. It has one of two processors (network/encoding/coping_net_settings.hpp).
//
// Factors of a tree read the features of joints, factors of all couplings read the blocks of the scaled system.
#pragma once

#include "network/encoding/feature_encoder.hpp"
#include "network/graph/topology.hpp"
#include "network/processor/coupled_factors.hpp"
#include "network/processor/factor_sweeps.hpp"
#include "network/processor/message_passing.hpp"

namespace rodsweep {

template <class T>
class CopingNet {
 public:
  struct Tape {
    Tensor<T> ordered, y_ordered, dy_ordered;  ///< sorted by level
    typename FactorSweeps<T>::Tape factors;
    typename CoupledFactors<T>::Tape coupled;
    typename MessagePassing<T>::Tape messages;
  };

  CopingNet(const CopingNetSettings& settings, std::uint64_t seed);

  const CopingNetSettings& settings() const { return settings_; }
  Parameters<T>& parameters() { return parameters_; }
  const Parameters<T>& parameters() const { return parameters_; }

  /// nodes [node features, segments], edges [edge features, places] -> y_edges [6, places] (`state`: [0, places]) and,
  /// if given, y_nodes [6, segments]. `systems`, in the places of edges, is only for factors of all couplings.
  void forward(const Topology& topology, const TensorIn<T>& nodes, const TensorIn<T>& edges, Tape& tape,
               Tensor<T>& y_edges, Tensor<T>* y_nodes, const ScaledSystem<T>* systems = nullptr) const;
  /// Adds to `gradient`.
  void backward(const Topology& topology, const TensorIn<T>& nodes, const TensorIn<T>& edges, Tape& tape,
                const TensorIn<T>& dy_edges, const Tensor<T>* dy_nodes, Parameters<T>& gradient,
                const ScaledSystem<T>* systems = nullptr) const;

  const FactorSweeps<T>& factors() const { return factors_; }
  const CoupledFactors<T>& coupled() const { return coupled_; }

 private:
  CopingNetSettings settings_;
  Parameters<T> parameters_;
  FactorSweeps<T> factors_;
  CoupledFactors<T> coupled_;
  MessagePassing<T> messages_;
};

}  // namespace rodsweep
