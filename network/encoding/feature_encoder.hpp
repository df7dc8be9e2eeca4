// What a COPINGNet is given of a linear system and its base guess, and in which units it answers: one interface for all
// encodings.
//
// The network corrects x_base: x = x_base + unit * y, entry by entry.
//   deck, physics   features of segments and joints (graph_encoding.hpp), with a base guess also x_base on the joints,
//                   all normalised; unit: how much each component of x - x_base deviates in the training set
//   system          features of the scaled system A^ d^ = r^ alone (system_encoding.hpp), which need no normalisation;
//                   unit: the scale of d^
//   canonical       the same in canonical frames (canonical_encoding.hpp); for factors of all couplings, which look at
//                   the matrix themselves, these frames alone and no features
// `state`, which looks at no linear system, has an encoder of its own (state_encoding.hpp); only its sizes are here.
// Edge features are in the places of the rod's topology.
#pragma once

#include <memory>

#include "network/encoding/canonical_encoding.hpp"
#include "network/encoding/coping_net_settings.hpp"
#include "network/encoding/normalisation.hpp"
#include "network/encoding/system_encoding.hpp"
#include "network/graph/topology.hpp"

namespace rodsweep {

/// What encodings of graphs and states take from a training set; empty for others.
struct FeatureScales {
  Normalisation nodes, edges;
  Normalisation multipliers;  ///< of x - x_base, six; of guesses
  Normalisation moves;        ///< of the segments' moves, six; where the network predicts them
};

/// Features of a segment, and of a joint with those of the base guess.
int node_features(const CopingNetSettings& settings);
int edge_features(const CopingNetSettings& settings);
/// Sizes of groups of components, for network/encoding/normalisation.hpp.
std::vector<int> node_groups(const CopingNetSettings& settings);
std::vector<int> edge_groups(const CopingNetSettings& settings);

class FeatureEncoder {
 public:
  /// Of a rod; `a` is the matrix of its linear systems.
  FeatureEncoder(const CopingNetSettings& settings, const Rod& rod, const BlockMatrix& a);

  const Topology& topology() const { return *topology_; }
  const std::shared_ptr<const Topology>& shared_topology() const { return topology_; }
  const SystemPattern& pattern() const { return pattern_; }

  /// Sets the features without normalisation, [node features, segments] and [edge features, places], from the system
  /// assembled at the rod's state with dt_c, x_base and b - A x_base. Allocates nothing.
  void encode(const Rod& rod, const LinearSystem& system, int newton, double dt_c, const VectorX& base,
              const VectorX& residual, Eigen::Ref<Tensor<float>> nodes, Eigen::Ref<Tensor<float>> edges);

  /// Of the system last encoded by `system`: the unit, in the order of unknowns.
  const VectorX& system_unit() const { return system_unit_; }
  /// Of `canonical`; else null.
  const CanonicalEncoding* canonical() const { return canonical_.get(); }

 private:
  CopingNetSettings settings_;
  std::shared_ptr<const Topology> topology_;
  SystemPattern pattern_;
  std::unique_ptr<GraphEncoding> graph_;          // deck, physics
  std::unique_ptr<SystemEncoding> system_;        // system
  std::unique_ptr<CanonicalEncoding> canonical_;  // canonical
  Tensor<float> by_joint_;
  VectorX system_unit_;
};

}  // namespace rodsweep
