// The inputs of a COPINGNet from a linear system and its base guess, and the units of its outputs.
//
// The network corrects x_base: x = x_base + unit * y, entry by entry.
//   paper, paper_residual   features of segments and joints (graph_encoding.hpp), with a base guess also x_base of the
//                           joints, all normalised; unit: the deviation of each component of x - x_base in the training
//                           set
//   linear_system           features of the scaled system A^ d^ = r^ (system_encoding.hpp), not normalised; unit: the
//                           scale of d^. Factors of all couplings read the matrix directly, so only the frames are
//                           found for them.
// `state` uses no linear system: it has its own encoder (state_encoding.hpp), and only its sizes are here.
// Edge features are in the order of the topology's places.
#pragma once

#include <memory>

#include "network/encoding/coping_net_settings.hpp"
#include "network/encoding/normalisation.hpp"
#include "network/encoding/system_encoding.hpp"
#include "network/graph/topology.hpp"

namespace rodsweep {

/// The scales of a training set, for encodings of graphs and states; empty for others.
struct FeatureScales {
  Normalisation nodes, edges;
  Normalisation multipliers;  ///< of x - x_base, six; for guesses only
  Normalisation moves;        ///< of the segments' moves, six; if the network predicts them
};

/// Number of features of a segment, and of a joint including those of the base guess.
int node_features(const CopingNetSettings& settings);
int edge_features(const CopingNetSettings& settings);
/// Sizes of groups of components, for network/encoding/normalisation.hpp.
std::vector<int> node_groups(const CopingNetSettings& settings);
std::vector<int> edge_groups(const CopingNetSettings& settings);

class FeatureEncoder {
 public:
  /// `a` is the matrix of the rod's linear systems.
  FeatureEncoder(const CopingNetSettings& settings, const Rod& rod, const BlockMatrix& a);

  const Topology& topology() const { return *topology_; }
  const std::shared_ptr<const Topology>& shared_topology() const { return topology_; }
  const SystemPattern& pattern() const { return pattern_; }

  /// Sets the features without normalisation, [node features, segments] and [edge features, places], from the system
  /// assembled at the rod's state, x_base and b - A x_base. Allocates nothing.
  void encode(const Rod& rod, const LinearSystem& system, int newton, const VectorX& base, const VectorX& residual,
              Eigen::Ref<Tensor<float>> nodes, Eigen::Ref<Tensor<float>> edges);

  /// Null unless the encoding is `linear_system`.
  const SystemEncoding* system() const { return system_.get(); }

 private:
  CopingNetSettings settings_;
  std::shared_ptr<const Topology> topology_;
  SystemPattern pattern_;
  std::unique_ptr<GraphEncoding> graph_;    // paper, paper_residual
  std::unique_ptr<SystemEncoding> system_;  // linear_system
  Tensor<float> by_joint_;
};

}  // namespace rodsweep
