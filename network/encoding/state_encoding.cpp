#include "network/encoding/state_encoding.hpp"

#include <cmath>

#include "network/encoding/joint_moduli.hpp"

namespace rodsweep {

const std::vector<int>& StateEncoding::node_groups() {
  static const std::vector<int> groups{3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 1, 1, 1, 1};
  return groups;
}

const std::vector<int>& StateEncoding::edge_groups() {
  static const std::vector<int> groups{3, 3, 3, 3, 1, 1, 1};
  return groups;
}

StateEncoding::StateEncoding(const Rod& rod, const Vector3& gravity_m_s2)
    : gravity_(gravity_m_s2),
      topology_(std::make_shared<const Topology>(rodsweep::topology(rod))),
      constants_(4, rod.segment_count()),
      moduli_(2, rod.joint_count()) {
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    const Segment& segment = rod.segments[s];
    const Eigen::Vector4d column(segment.radius_m, segment.density_kg_m3, segment.length_m, segment.is_static);
    constants_.col(static_cast<Eigen::Index>(s)) = column.cast<float>();
  }
  for (int k = 0; k < rod.joint_count(); ++k)
    moduli_.col(k) = joint_moduli(rod, rod.joints[static_cast<std::size_t>(k)]).array().log10().cast<float>();
}

void StateEncoding::encode(const Rod& rod, const StateHistory& history, Eigen::Ref<Tensor<float>> nodes,
                           Eigen::Ref<Tensor<float>> edges) const {
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    auto out = nodes.col(static_cast<Eigen::Index>(s));
    const Matrix3 to_local = history.orientation(s).toRotationMatrix().transpose();
    for (std::size_t ago = 0; ago < StateHistory::length; ++ago) {
      const auto row = static_cast<Eigen::Index>(6 * ago);
      out.segment<3>(row) = (to_local * history.motion(s, ago).velocity).cast<float>();
      out.segment<3>(row + 3) = (to_local * history.motion(s, ago).spin).cast<float>();
    }
    out.segment<3>(30) = (to_local * gravity_).cast<float>();
    out.segment<4>(33) = constants_.col(static_cast<Eigen::Index>(s));
  }
  for (Eigen::Index place = 0; place < edges.cols(); ++place) {
    auto out = edges.col(place);
    const int number = topology_->joint[static_cast<std::size_t>(place)];
    const Joint& joint = rod.joints[static_cast<std::size_t>(number)];
    const auto a = static_cast<std::size_t>(joint.a), b = static_cast<std::size_t>(joint.b);
    const Quaternion to_local = history.orientation(a).conjugate();
    const Vector3 apart = to_local * (history.position(b) - history.position(a));
    Quaternion between = to_local * history.orientation(b);
    const Vector3 lacks = joint.arm_a - apart - between * joint.arm_b;
    between = joint.rest().conjugate() * between;
    out.segment<3>(0) = (lacks / joint.length).cast<float>();
    out.segment<3>(3) = (apart / joint.length).cast<float>();
    out.segment<3>(6) = ((between.w() < 0 ? -2 : 2) * between.vec()).cast<float>();
    out.segment<3>(9) = (2 * joint.rest().vec()).cast<float>();
    out.segment<2>(12) = moduli_.col(number);
    out[14] = static_cast<float>(joint.length);
  }
}

void StateEncoding::answer(const Rod& rod, const StateHistory& history, const std::vector<Vector3>& velocity,
                           const std::vector<Vector3>& spin, Eigen::Ref<Tensor<float>> out) {
  out.setZero();
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    if (rod.segments[s].is_static) continue;
    const Quaternion to_local = history.orientation(s).conjugate();
    auto column = out.col(static_cast<Eigen::Index>(s));
    column.head<3>() = (to_local * (velocity[s] - history.motion(s).velocity)).cast<float>();
    column.tail<3>() = (to_local * (spin[s] - history.motion(s).spin)).cast<float>();
  }
}

void roll(const std::vector<int>& groups, double angle, Eigen::Ref<Tensor<float>> columns) {
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  Eigen::Matrix2f turn;
  turn << c, s, -s, c;
  Eigen::Index row = 0;
  for (const int size : groups) {
    if (size == 3) columns.middleRows<2>(row) = (turn * columns.middleRows<2>(row)).eval();
    row += size;
  }
}

}  // namespace rodsweep
