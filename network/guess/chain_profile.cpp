#include "network/guess/chain_profile.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace rodsweep {
namespace {

constexpr double rigid = 1e15;  // [N m^2], stiffness of a joint without compliance

[[noreturn]] void not_a_chain(const std::string& what) {
  throw SceneError(what + "; must be a single chain: nearest neighbours compare rods along their arc length");
}

/// The joints of a chain and the segments between and around them, from one end to the other.
struct Chain {
  std::vector<int> joints, segments;

  explicit Chain(const Rod& rod) {
    std::vector<std::vector<int>> joints_of(rod.segments.size());
    for (int k = 0; k < rod.joint_count(); ++k)
      for (const int s : {rod.joints[at(k)].a, rod.joints[at(k)].b}) joints_of[at(s)].push_back(k);
    int start = -1;
    for (int s = 0; s < rod.segment_count(); ++s) {
      const std::size_t joints_here = joints_of[at(s)].size();
      if (joints_here > 2)
        not_a_chain("segment " + std::to_string(s) + " has " + std::to_string(joints_here) + " joints");
      if (joints_here == 1 && (start < 0 || (rod.segments[at(s)].is_static && !rod.segments[at(start)].is_static)))
        start = s;
    }
    if (start < 0) not_a_chain("no segment is an end");
    segments.push_back(start);
    for (int from = -1;;) {
      const int s = segments.back();
      const std::vector<int>& here = joints_of[at(s)];
      const auto next = std::find_if(here.begin(), here.end(), [&](int joint) { return joint != from; });
      if (next == here.end()) break;
      from = *next;
      joints.push_back(from);
      segments.push_back(rod.joints[at(from)].a == s ? rod.joints[at(from)].b : rod.joints[at(from)].a);
    }
    if (segments.size() != rod.segments.size()) not_a_chain("segments are not connected");
  }
};

}  // namespace

const std::vector<int>& ChainProfile::state_groups() {
  static const std::vector<int> groups{3, 3, 3, 3, 3};
  return groups;
}

ChainProfile::ChainProfile(const Rod& rod, const Vector3& gravity_m_s2)
    : acceleration_m_s2_(gravity_m_s2.norm() > 0 ? gravity_m_s2.norm() : 1) {
  const Chain chain(rod);
  std::vector<double> reached;  // [m] at the joint after each segment
  for (const int s : chain.segments) {
    const Segment& segment = rod.segments[at(s)];
    if (!segment.is_static) {
      length_m_ += segment.length_m;
      mass_kg_ += segment.mass;
    }
    reached.push_back(length_m_);
  }
  if (length_m_ <= 0) not_a_chain("every segment is static");
  Eigen::Array2d stiffness(0, 0);
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const Joint& joint = rod.joints[at(chain.joints[i])];
    length_.push_back(joint.length);
    sign_.push_back(joint.a == chain.segments[i] ? 1 : -1);
    arc_.push_back(static_cast<float>(reached[i] / length_m_));
    const Eigen::Array2d compliance((joint.compliance[3] + joint.compliance[4]) / 2, joint.compliance[5]);
    stiffness += (joint.length / compliance).min(rigid).log10() / static_cast<double>(chain.joints.size());
  }
  joint_ = chain.joints;
  stiffness -= std::log10(mass_kg_ * acceleration_m_s2_ * length_m_ * length_m_);
  constants_ = stiffness.cast<float>();
}

void ChainProfile::state(const Rod& rod, const LinearSystem& system, double dt_c, Tensor<float>& out) const {
  const double time = std::sqrt(length_m_ / acceleration_m_s2_);
  Vector3 first = Vector3::Zero(), gap = Vector3::Zero();
  for (std::size_t i = 0; i < joint_.size(); ++i) {
    const Joint& joint = rod.joints[at(joint_[i])];
    Vector3 point = Vector3::Zero(), velocity = Vector3::Zero(), spin = Vector3::Zero();
    int free_sides = 0;
    for (const bool is_b : {false, true}) {
      const std::size_t s = at(is_b ? joint.b : joint.a);
      const Vector3 arm = rod.orientation[s] * (is_b ? joint.arm_b : joint.arm_a);
      point += (rod.position[s] + arm) / 2;
      if (rod.segments[s].is_static) continue;
      velocity += rod.velocity[s] + rod.angular_velocity[s].cross(arm);
      spin += rod.angular_velocity[s];
      ++free_sides;
    }
    const Vector6 b = sign_[i] * system.rhs().segment<6>(6 * joint_[i]);
    if (i == 0) first = point;
    gap += to_world(rod, joint, length_[i] * b.head<3>());
    auto to = out.col(static_cast<Eigen::Index>(i));
    to.segment<3>(0) = ((point - first) / length_m_).cast<float>();
    to.segment<3>(3) = (-length_m_ / length_[i] * b.tail<3>()).cast<float>();
    to.segment<3>(6) = (gap / (acceleration_m_s2_ * dt_c * dt_c)).cast<float>();
    to.segment<3>(9) = (time / (length_m_ * free_sides) * velocity).cast<float>();
    to.segment<3>(12) = (time / free_sides * spin).cast<float>();
  }
}

/// A multiplier divided by this is a load.
Vector6 ChainProfile::load_unit(std::size_t place, double dt_c) const {
  const double force = sign_[place] * mass_kg_ * acceleration_m_s2_ * dt_c * dt_c;
  Vector6 unit;
  unit << Vector3::Constant(force * length_[place]), Vector3::Constant(force * length_m_);
  return unit;
}

void ChainProfile::loads(const VectorX& multipliers, double dt_c, Tensor<float>& out) const {
  for (std::size_t i = 0; i < joint_.size(); ++i)
    out.col(static_cast<Eigen::Index>(i)) =
        multipliers.segment<6>(6 * joint_[i]).cwiseQuotient(load_unit(i, dt_c)).cast<float>();
}

void ChainProfile::multipliers(const Tensor<float>& loads, double dt_c, VectorX& out) const {
  for (std::size_t i = 0; i < joint_.size(); ++i)
    out.segment<6>(6 * joint_[i]) =
        loads.col(static_cast<Eigen::Index>(i)).cast<double>().cwiseProduct(load_unit(i, dt_c));
}

void add_resampled(const std::vector<float>& from, const Eigen::Ref<const Tensor<float>>& values,
                   const std::vector<float>& to, float weight, Eigen::Ref<Tensor<float>> out) {
  std::size_t i = 0;  // interval
  for (std::size_t k = 0; k < to.size(); ++k) {
    while (i + 2 < from.size() && from[i + 1] < to[k]) ++i;
    const auto left = static_cast<Eigen::Index>(i), right = std::min<Eigen::Index>(left + 1, values.cols() - 1);
    const float span = from[static_cast<std::size_t>(right)] - from[i];
    const float t = span > 0 ? (to[k] - from[i]) / span : 0;
    out.col(static_cast<Eigen::Index>(k)) += weight * ((1 - t) * values.col(left) + t * values.col(right));
  }
}

}  // namespace rodsweep
