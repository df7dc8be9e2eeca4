#include "solver/scenes.hpp"

#include <cmath>
#include <string>
#include <utility>

namespace rodsweep {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double standard_gravity = 9.81;

/// A rod whose joints lie on `vertices`; orientations are parallel-transported along it.
Rod rod_through(const std::vector<Vector3>& vertices, const RodParameters& p) {
  const int n = static_cast<int>(vertices.size()) - 1;
  std::vector<SegmentSpec> segments;
  Quaternion orientation = Quaternion::Identity();
  double mass = 0;
  if (p.clamp == Clamp::wall) {
    SegmentSpec wall;
    wall.position_m = vertices.front();
    wall.is_static = true;
    segments.push_back(wall);
  }
  for (int i = 0; i < n; ++i) {
    const Vector3 chord = vertices[static_cast<std::size_t>(i) + 1] - vertices[static_cast<std::size_t>(i)];
    const Vector3 before = orientation * Vector3::UnitZ();
    orientation = (Quaternion::FromTwoVectors(before, chord) * orientation).normalized();
    SegmentSpec s;
    s.position_m = vertices[static_cast<std::size_t>(i)] + chord / 2;
    s.orientation = orientation;
    s.length_m = chord.norm();
    s.radius_m = p.radius_m;
    s.density_kg_m3 = p.density_kg_m3;
    s.is_static = i == 0 && p.clamp == Clamp::segment;
    segments.push_back(s);
    mass += p.density_kg_m3 * pi * p.radius_m * p.radius_m * s.length_m;
  }
  if (p.clamp == Clamp::wall) segments.front().orientation = segments[1].orientation;

  const double force = mass * std::max(p.gravity_m_s2.norm(), standard_gravity) + p.tip_force_n.norm();
  std::vector<JointSpec> joints;
  for (std::size_t b = 1; b < segments.size(); ++b) {
    JointSpec joint;
    joint.a = static_cast<int>(b) - 1;
    joint.b = static_cast<int>(b);
    joint.arm_a_m = Vector3(0, 0, segments[b - 1].length_m / 2);
    joint.arm_b_m = Vector3(0, 0, -segments[b].length_m / 2);
    const double length = (segments[b - 1].length_m + segments[b].length_m) / 2;
    joint.compliance_per_j = joint_compliance(
        length, p.radius_m, p.youngs_modulus_pa, p.torsion_modulus_pa,
        p.stretch_compliance_per_j ? *p.stretch_compliance_per_j : inextensible_compliance(length, force));
    joints.push_back(joint);
  }
  return Rod(segments, joints);
}

std::vector<Vector3> vertices_of(const BendingRod& p) {
  const double angle = p.initial_angle_deg * pi / 180;
  const Vector3 along = p.length_m / p.segments * Vector3(std::cos(angle), std::sin(angle), 0);
  std::vector<Vector3> out;
  for (int i = 0; i <= p.segments; ++i) out.push_back(i * along);
  return out;
}

std::vector<Vector3> vertices_of(const Helix& p) {
  std::vector<Vector3> out;
  for (int i = 0; i <= p.segments; ++i) {
    const double fraction = static_cast<double>(i) / p.segments;
    const double t = 2 * pi * p.windings * fraction;
    out.emplace_back(p.helix_radius_m * std::cos(t), -p.helix_height_m * fraction, p.helix_radius_m * std::sin(t));
  }
  return out;
}

void check(const RodParameters& p) {
  const int least = p.clamp == Clamp::segment ? 2 : 1;
  if (p.segments < least)
    throw SceneError("segments is " + std::to_string(p.segments) + "; must be at least " + std::to_string(least) +
                     (least == 2 ? ": the clamp \"segment\" holds the first one" : ""));
}

}  // namespace

Scene build_scene(const SceneSpec& spec) {
  return std::visit(
      [](const auto& p) {
        check(p);
        Scene scene;
        scene.rods.push_back(rod_through(vertices_of(p), p));
        scene.gravity_m_s2 = p.gravity_m_s2;
        scene.damping_per_s = p.damping_per_s;
        if (!p.tip_force_n.isZero()) {
          const int tip = scene.rods.front().segment_count() - 1;
          const double half = scene.rods.front().segments.back().length_m / 2;
          scene.loads.push_back({0, tip, p.tip_force_n, Vector3::Zero(), Vector3(0, 0, half)});
        }
        return scene;
      },
      spec);
}

int segment_count(const SceneSpec& spec) {
  return std::visit([](const auto& p) { return p.segments + (p.clamp == Clamp::wall ? 1 : 0); }, spec);
}

}  // namespace rodsweep
