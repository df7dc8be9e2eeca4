#include "network/encoding/graph_encoding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "network/encoding/joint_moduli.hpp"

namespace rodsweep {
namespace {

/// Distances of segments from the root of their connected piece.
struct ArcLength {
  std::vector<double> distance;  ///< [m] from the root
  std::vector<std::size_t> roots;

  explicit ArcLength(const Rod& rod) : distance(rod.segments.size(), std::numeric_limits<double>::infinity()) {
    for (const bool is_static : {true, false})
      for (std::size_t s = 0; s < distance.size(); ++s)
        if (rod.segments[s].is_static == is_static && std::isinf(distance[s])) {
          roots.push_back(s);
          distance[s] = 0;
          spread(rod);
        }
  }

 private:
  void spread(const Rod& rod) {
    for (bool shortened = true; shortened;) {
      shortened = false;
      for (const Joint& joint : rod.joints) {
        double &a = distance[static_cast<std::size_t>(joint.a)], &b = distance[static_cast<std::size_t>(joint.b)];
        const double nearer_a = std::min(a, b + joint.length), nearer_b = std::min(b, a + joint.length);
        shortened = shortened || nearer_a < a || nearer_b < b;
        a = nearer_a;
        b = nearer_b;
      }
    }
  }
};

}  // namespace

const GraphEncoding::Groups& GraphEncoding::groups(Encoding encoding) {
  static const Groups paper{{3, 4, 1, 1, 1, 1, 1, 1, 1}, {3, 1, 1}};
  static const Groups paper_residual{paper.nodes, {3, 1, 1, 3, 3}};
  if (!is_of_graphs(encoding))
    throw std::invalid_argument("GraphEncoding: the encoding must be paper or paper_residual");
  return encoding == Encoding::paper ? paper : paper_residual;
}

int GraphEncoding::node_features(Encoding encoding) {
  const std::vector<int>& sizes = groups(encoding).nodes;
  return std::accumulate(sizes.begin(), sizes.end(), 0);
}

int GraphEncoding::edge_features(Encoding encoding) {
  const std::vector<int>& sizes = groups(encoding).edges;
  return std::accumulate(sizes.begin(), sizes.end(), 0);
}

GraphEncoding::GraphEncoding(Encoding encoding, const Rod& rod)
    : encoding_(encoding), constants_(7, rod.segment_count()), moduli_(2, rod.joint_count()) {
  groups(encoding);  // throws for other encodings
  const ArcLength arc(rod);
  const double farthest = *std::max_element(arc.distance.begin(), arc.distance.end());
  std::vector<int> joints_at(rod.segments.size(), 0);
  for (int k = 0; k < rod.joint_count(); ++k) {
    const Joint& joint = rod.joints[static_cast<std::size_t>(k)];
    ++joints_at[static_cast<std::size_t>(joint.a)];
    ++joints_at[static_cast<std::size_t>(joint.b)];
    moduli_.col(k) = joint_moduli(rod, joint).cast<float>();
  }
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    const Segment& segment = rod.segments[s];
    const bool first = std::find(arc.roots.begin(), arc.roots.end(), s) != arc.roots.end();
    const bool last = !first && joints_at[s] == 1;
    const double alpha = farthest > 0 ? arc.distance[s] / farthest : 0;
    Eigen::Matrix<double, 7, 1> column;
    column << segment.radius_m, segment.density_kg_m3, segment.length_m, alpha, segment.is_static, first, last;
    constants_.col(static_cast<Eigen::Index>(s)) = column.cast<float>();
  }
}

void GraphEncoding::encode(const Rod& rod, const LinearSystem& system, int newton, Eigen::Ref<Tensor<float>> nodes,
                           Eigen::Ref<Tensor<float>> edges) const {
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    auto out = nodes.col(static_cast<Eigen::Index>(s));
    const Quaternion& q = rod.orientation[s];
    const double sign = q.w() < 0 ? -1 : 1;
    out.segment<3>(0) = rod.position[s].cast<float>();
    out.segment<4>(3) = (sign * Eigen::Vector4d(q.w(), q.x(), q.y(), q.z())).cast<float>();
    out.segment<7>(7) = constants_.col(static_cast<Eigen::Index>(s));
  }
  for (std::size_t k = 0; k < rod.joints.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    auto out = edges.col(column);
    const Joint& joint = rod.joints[k];
    const Vector3 turned = system.linearization().constraint.segment<3>(6 * column + 3) / 2;  // Im(e)
    Quaternion e;
    e.vec() = turned;
    e.w() = std::sqrt(std::max(0.0, 1 - turned.squaredNorm()));
    const Quaternion d = joint.frame_a * e * joint.frame_b.conjugate();
    out.segment<3>(0) = (2 / joint.length * d.vec()).cast<float>();
    out.segment<2>(3) = moduli_.col(column);
    if (encoding_ == Encoding::paper) continue;
    const Vector6 residual = system.rhs().segment<6>(6 * column);
    out.segment<6>(5) = (newton > 0 ? residual : Vector6::Zero()).cast<float>();
  }
}

}  // namespace rodsweep
