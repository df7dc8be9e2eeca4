#include "network/encoding/feature_encoder.hpp"

#include <numeric>
#include <stdexcept>

#include "network/encoding/state_encoding.hpp"

namespace rodsweep {
namespace {

bool of_graphs(const CopingNetSettings& settings) { return is_of_graphs(settings.encoding); }

int sum(const std::vector<int>& sizes) { return std::accumulate(sizes.begin(), sizes.end(), 0); }

/// A topology's places are those of its forest's order.
SystemPattern pattern_of(const Topology& topology, const BlockMatrix& a) {
  JointForest forest = topology.forest;
  forest.order = topology.joint;
  return system_pattern(forest, a);
}

}  // namespace

std::vector<int> node_groups(const CopingNetSettings& settings) {
  if (settings.encoding == Encoding::state) return StateEncoding::node_groups();
  return of_graphs(settings) ? GraphEncoding::groups(settings.encoding).nodes : std::vector<int>{};
}

std::vector<int> edge_groups(const CopingNetSettings& settings) {
  if (settings.encoding == Encoding::state) return StateEncoding::edge_groups();
  if (!of_graphs(settings)) return {SystemEncoding::size};
  std::vector<int> groups = GraphEncoding::groups(settings.encoding).edges;
  if (settings.base != BaseGuess::none) groups.insert(groups.end(), {3, 3});
  return groups;
}

int node_features(const CopingNetSettings& settings) { return sum(node_groups(settings)); }
int edge_features(const CopingNetSettings& settings) { return sum(edge_groups(settings)); }

FeatureEncoder::FeatureEncoder(const CopingNetSettings& settings, const Rod& rod, const BlockMatrix& a)
    : settings_(settings),
      topology_(std::make_shared<const Topology>(rodsweep::topology(rod))),
      pattern_(pattern_of(*topology_, a)) {
  if (!is_guess(settings)) throw std::invalid_argument("FeatureEncoder: the encoding state uses no linear system");
  if (of_graphs(settings)) {
    graph_ = std::make_unique<GraphEncoding>(settings.encoding, rod);
    by_joint_.resize(GraphEncoding::edge_features(settings.encoding), rod.joint_count());
  } else {
    system_ = std::make_unique<SystemEncoding>(
        pattern_, settings.processor == Processor::factors ? Alignment::matrix : Alignment::residual);
  }
}

void FeatureEncoder::encode(const Rod& rod, const LinearSystem& system, int newton, const VectorX& base,
                            const VectorX& residual, Eigen::Ref<Tensor<float>> nodes, Eigen::Ref<Tensor<float>> edges) {
  if (has_all_couplings(settings_)) return system_->find(pattern_, system.matrix(), residual);
  if (system_) return system_->encode(pattern_, system.matrix(), residual, edges);
  graph_->encode(rod, system, newton, nodes, by_joint_);
  const Eigen::Index own = by_joint_.rows();
  for (Eigen::Index place = 0; place < edges.cols(); ++place) {
    const int joint = topology_->joint[static_cast<std::size_t>(place)];
    edges.col(place).head(own) = by_joint_.col(joint);
    if (edges.rows() > own) edges.col(place).tail<6>() = base.segment<6>(6 * joint).cast<float>();
  }
}

}  // namespace rodsweep
