// Features of nodes (segments) and edges (joints) for message passing: the inputs of Shao et al. 2021.
//
// At the positions p^j of Newton iteration j:
//   paper            node 14: x [m], q (w, x, y, z; the hemisphere w >= 0), r [m], rho [kg/m^3], segment length [m],
//                             alpha, and whether fixed, first (a root), last (a tip)
//                    edge 5:  Darboux vector Omega = (2/l) Im(conj(q_a) q_b) [1/m], Y, T [Pa]
//   paper_residual   node 14: the same
//                    edge 11: the same, and from j = 1 on the constraint residual -C - alpha~ lambda (0 at j = 0)
// alpha is the distance of a segment's centre from the root along the joints, over the largest. The root of a connected
// piece is its first static segment, or its first segment if none is static. Y and T are the moduli of the joint's
// bend-twist compliance (l / EI, l / GJ).
#pragma once

#include <vector>

#include "network/layers/tensor.hpp"
#include "solver/linear/linear_system.hpp"

namespace rodsweep {

/// `linear_system`: network/encoding/system_encoding.hpp; `state`: state_encoding.hpp.
enum class Encoding { paper, paper_residual, linear_system, state };

/// Whether features describe segments and joints rather than the linear system.
constexpr bool is_of_graphs(Encoding encoding) {
  return encoding == Encoding::paper || encoding == Encoding::paper_residual;
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

  /// Throws std::invalid_argument unless is_of_graphs(encoding).
  GraphEncoding(Encoding encoding, const Rod& rod);

  /// Writes [node_features, segments] and [edge_features, joints]; `system` is that of the rod's state. Allocates
  /// nothing.
  void encode(const Rod& rod, const LinearSystem& system, int newton, Eigen::Ref<Tensor<float>> nodes,
              Eigen::Ref<Tensor<float>> edges) const;

 private:
  Encoding encoding_;
  Tensor<float> constants_;  ///< [7, segments]: r ... last
  Tensor<float> moduli_;     ///< [2, joints]: Y, T
};

}  // namespace rodsweep
