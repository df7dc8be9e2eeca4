#include "solver/scene/scene_parts.hpp"

#include <algorithm>
#include <sstream>
#include <string>

#include "solver/linear/interruption.hpp"
#include "solver/numbers/rotation.hpp"

namespace rodsweep {
namespace {

constexpr double standard_gravity = 9.81;
constexpr int most_segments = 10000000;

struct SectionOf {
  double radius_m, nu;
  CrossSection operator()(const Tube& s) const { return tube(radius_m, s.wall_m, nu); }
  CrossSection operator()(const Ellipse& s) const { return ellipse(s.width_m, s.height_m, nu); }
  CrossSection operator()(const Rectangle& s) const { return rectangle(s.width_m, s.height_m, nu); }
  CrossSection operator()(const GivenSection& s) const {
    return {s.area_m2, s.second_moment_height_m4, s.second_moment_width_m4, s.torsion_constant_m4, s.shear_coefficient};
  }
};

}  // namespace

CrossSection cross_section(const RodParameters& p) {
  const double nu = poisson_number(p.youngs_modulus_pa, p.torsion_modulus_pa);
  return p.section ? std::visit(SectionOf{p.radius_m, nu}, *p.section) : circle(p.radius_m, nu);
}

Section stiffness(const RodParameters& p) {
  return stiffness(cross_section(p), p.youngs_modulus_pa, p.torsion_modulus_pa);
}

std::vector<Vector3> straight_line(const Vector3& from, const Vector3& to, int pieces) {
  std::vector<Vector3> vertices;
  for (int i = 0; i <= pieces; ++i) vertices.push_back(from + static_cast<double>(i) / pieces * (to - from));
  return vertices;
}

std::vector<SegmentSpec> segments_through(const std::vector<Vector3>& vertices, const RodParameters& p) {
  std::vector<SegmentSpec> segments;
  Quaternion orientation = Quaternion::Identity();
  for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
    const Vector3 chord = vertices[i + 1] - vertices[i];
    const Vector3 before = orientation * Vector3::UnitZ();
    orientation = (turn_between(before, chord) * orientation).normalized();
    segments.push_back(segment_at(vertices[i] + chord / 2, orientation, chord.norm(), p));
  }
  return segments;
}

Rod chain(const std::vector<SegmentSpec>& segments, const RodParameters& p, double force_n, bool straight) {
  check_interrupted(500ll * static_cast<std::int64_t>(segments.size()));
  std::vector<JointSpec> joints;
  for (int b = 1; b < static_cast<int>(segments.size()); ++b) {
    joints.push_back(joint_between(segments, b - 1, b, p, force_n));
    if (straight) joints.back().rest = Quaternion::Identity();
  }
  return Rod(segments, joints);
}

SegmentSpec segment_at(const Vector3& centre, const Quaternion& orientation, double length_m, const RodParameters& p) {
  SegmentSpec s{centre, orientation, length_m, p.radius_m, p.density_kg_m3};
  if (p.section) s.section = cross_section(p);
  return s;
}

SegmentSpec held_point(const Vector3& at, const Quaternion& orientation) { return {at, orientation, 0, 0, 0, true}; }

void set_height(SegmentSpec& segment, const Vector3& height) {
  Matrix3 axes;
  axes.col(2) = segment.orientation * Vector3::UnitZ();
  axes.col(0) = height.cross(axes.col(2)).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  segment.orientation = Quaternion(axes).normalized();
}

JointSpec joint_between(const std::vector<SegmentSpec>& segments, int a, int b, const RodParameters& p,
                        double force_n) {
  const double length_a = segments[at(a)].length_m;
  const double length_b = segments[at(b)].length_m;
  const double length = (length_a + length_b) / 2;
  const Section section = stiffness(p);
  JointSpec joint{a, b, {0, 0, length_a / 2}, {0, 0, -length_b / 2}};
  joint.compliance_per_j = p.stretch == Stretch::physical
                               ? physical_compliance(length, section)
                               : joint_compliance(length, section, stretch_compliance(length, force_n, p));
  return joint;
}

double stretch_compliance(double length_m, double force_n, const RodParameters& p) {
  return p.stretch_compliance_per_j.value_or(
      inextensible_compliance(length_m, force_n + p.prescribed.largest_force_n()));
}

void set_compliance(JointSpec& joint, const Series& series, double length_m, double force_n, const RodParameters& p) {
  if (p.stretch == Stretch::physical)
    joint.compliance_per_j.head<3>() = series.stretch / (length_m * length_m);
  else
    joint.compliance_per_j.head<3>().setConstant(stretch_compliance(length_m, force_n, p));
  joint.compliance_per_j.tail<3>() = series.bend;
}

JointSpec crossing_between(int a, int b, double stiffness_nm, double stretch_per_j) {
  JointSpec joint{a, b};
  joint.compliance_per_j.head<3>().setConstant(stretch_per_j);
  joint.compliance_per_j.tail<3>().setConstant(1 / stiffness_nm);
  return joint;
}

double weight(const std::vector<SegmentSpec>& segments, const RodParameters& p) {
  double mass = 0;
  for (const SegmentSpec& s : segments) mass += s.mass();
  return mass * std::max(p.prescribed.largest_gravity_m_s2(p.gravity_m_s2), standard_gravity);
}

std::string text_of(const Vector3& point) {
  std::ostringstream out;
  out << '[' << point.x() << ", " << point.y() << ", " << point.z() << ']';
  return out.str();
}

void move_clamp(Scene& scene, int segment, const Vector3& velocity_m_s) {
  const Rod& rod = scene.rods.front();
  const auto s = at(segment);
  scene.clamps.push_back({0, segment, [from = rod.position[s], turned = rod.orientation[s], velocity_m_s](double t) {
                            return Pose{from + t * velocity_m_s, turned};
                          }});
}

void check_least(const char* quantity, int value, int least, const char* why) {
  if (value < least)
    throw SceneError(std::string(quantity) + " is " + std::to_string(value) + "; must be at least " +
                     std::to_string(least) + why);
}

void check_segments(const char* scene, double segments) {
  if (segments > most_segments)
    throw SceneError(std::string(scene) + " has too many segments; the limit is " + std::to_string(most_segments));
}

}  // namespace rodsweep
