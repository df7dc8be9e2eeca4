// Rods as features of nodes (segments) and edges (joints), for message passing: those that know where a rod is.
//
// `paper`, `deck` and `physics`. At the positions p^j of Newton iteration j. alpha is the distance of a segment's
// centre from the root along the joints, over the largest; the root is the first static segment, else the first. Y and
// T are the moduli that the joint's bend-twist compliance (l / EI, l / GJ) stands for. v and w are those of the start
// of the step.
//   paper     node 14 as deck, edge 5: Omega, Y, T
//   deck      node 14: x [m], q (w, x, y, z; the hemisphere w >= 0), r [m], rho [kg/m^3], segment length [m], alpha,
//                      and whether fixed, first (a root), last (a tip)
//             edge 11: Darboux vector Omega [1/m], Y, T [Pa], and from j = 1 on -C - alpha~ lambda (0 at j = 0)
//   physics   node 20: (x - x_root) / L, q ... last as above, v dt_c / l_mean, w dt_c
//             edge 14: l Omega, log10 of Y and T, -C - alpha~ lambda at every j, l Omega0
// L is the rod's total length, l_mean its joints' mean length: a step's motion and the curvature are then in the units
// of the constraints, (x_a - x_b) / l and l (Omega - Omega0), whose balance the network is to find.
#pragma once

#include <vector>

#include "network/layers/tensor.hpp"
#include "solver/linear/linear_system.hpp"

namespace rodsweep {

/// `system`: network/encoding/system_encoding.hpp; `canonical`: canonical_encoding.hpp; `state`: state_encoding.hpp.
enum class Encoding { paper, deck, physics, system, canonical, state };

/// Of segments and joints, not of the linear system.
constexpr bool is_of_graphs(Encoding encoding) {
  return encoding == Encoding::paper || encoding == Encoding::deck || encoding == Encoding::physics;
}

class GraphEncoding {
 public:
  /// Sizes of the groups of features that are components of one quantity, in order.
  struct Groups {
    std::vector<int> nodes, edges;
  };
  static const Groups& groups(Encoding encoding);
  static int node_features(Encoding encoding);
  static int edge_features(Encoding encoding);

  /// Throws std::invalid_argument for an encoding that is not of graphs.
  GraphEncoding(Encoding encoding, const Rod& rod);

  /// Writes [node_features, segments] and [edge_features, joints]; `system` assembled at the rod's state with dt_c.
  /// Allocates nothing.
  void encode(const Rod& rod, const LinearSystem& system, int newton, double dt_c, Eigen::Ref<Tensor<float>> nodes,
              Eigen::Ref<Tensor<float>> edges) const;

 private:
  Encoding encoding_;
  std::size_t root_ = 0;
  double total_length_ = 0, mean_joint_length_ = 0;
  Tensor<float> constants_;  ///< [7, segments]: r ... last
  Tensor<float> moduli_;     ///< [2, joints]: Y, T or their logarithms
};

}  // namespace rodsweep
