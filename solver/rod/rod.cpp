#include "solver/rod/rod.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

namespace rodsweep {
namespace {

[[noreturn]] void refuse(const std::string& what, int index, const std::string& quantity, double value,
                         const std::string& bound) {
  std::ostringstream text;
  text << what << " " << index << ": " << quantity << " is " << value << "; must be " << bound;
  throw SceneError(text.str());
}

bool positive(double value) { return value > 0 && std::isfinite(value); }

Segment make_segment(const SegmentSpec& s, int index) {
  const bool point = s.is_static && s.length_m == 0;  // a wall: no extent, no mass needed
  if (!positive(s.length_m) && !point)
    refuse("segment", index, "length_m", s.length_m, "positive and finite (zero only when static)");
  if (!positive(s.radius_m) && !s.is_static) refuse("segment", index, "radius_m", s.radius_m, "positive and finite");
  if (!positive(s.density_kg_m3) && !s.is_static)
    refuse("segment", index, "density_kg_m3", s.density_kg_m3, "positive and finite");
  if (!s.position_m.allFinite()) throw SceneError("segment " + std::to_string(index) + ": position is not finite");
  if (!(std::abs(s.orientation.norm() - 1) < 1e-6))
    refuse("segment", index, "orientation norm", s.orientation.norm(), "1");

  Segment out{};
  out.length_m = s.length_m;
  out.radius_m = s.radius_m;
  out.density_kg_m3 = s.density_kg_m3;
  out.is_static = s.is_static;
  out.mass = s.density_kg_m3 * pi * s.radius_m * s.radius_m * s.length_m;
  out.inertia_transverse = out.mass * (3 * s.radius_m * s.radius_m + s.length_m * s.length_m) / 12;
  out.inertia_axial = out.mass * s.radius_m * s.radius_m / 2;
  if (!s.is_static) {
    out.inverse_mass = 1 / out.mass;
    out.turn_mobility = out.inverse_inertia_transverse = 1 / out.inertia_transverse;
    out.inverse_inertia_axial = 1 / out.inertia_axial;
    if (!std::isfinite(out.inverse_mass) || !std::isfinite(out.inverse_inertia_axial))
      refuse("segment", index, "mass", out.mass, "large enough to be inverted");
  }
  return out;
}

Joint make_joint(const JointSpec& j, const std::vector<SegmentSpec>& segments, int index) {
  const int n = static_cast<int>(segments.size());
  if (j.a < 0 || j.a >= n) refuse("joint", index, "segment a", j.a, "from 0 to " + std::to_string(n - 1));
  if (j.b < 0 || j.b >= n) refuse("joint", index, "segment b", j.b, "from 0 to " + std::to_string(n - 1));
  if (j.a == j.b) refuse("joint", index, "segment b", j.b, "different from segment a");
  const SegmentSpec &a = segments[static_cast<std::size_t>(j.a)], &b = segments[static_cast<std::size_t>(j.b)];
  Joint out{j.a,
            j.b,
            j.arm_a_m,
            j.arm_b_m,
            (a.length_m + b.length_m) / 2,
            j.compliance_per_j,
            Quaternion::Identity(),
            Quaternion::Identity()};
  if (!(out.length > 0)) refuse("joint", index, "length", out.length, "positive: two zero-length segments meet");
  for (int row = 0; row < 6; ++row)
    if (!(out.compliance[row] >= 0) || !std::isfinite(out.compliance[row]))
      refuse("joint", index, "compliance of row " + std::to_string(row), out.compliance[row], "finite and at least 0");
  if (!j.arm_a_m.allFinite() || !j.arm_b_m.allFinite())
    throw SceneError("joint " + std::to_string(index) + ": an arm is not finite");
  const auto check_norm = [index](const std::optional<Quaternion>& q, const char* quantity) {
    if (q && !(std::abs(q->norm() - 1) < 1e-6)) refuse("joint", index, quantity, q->norm(), "1");
  };
  check_norm(j.rest, "norm of the rest rotation");
  check_norm(j.frame, "norm of the frame's rotation");
  set_rest(out, j.rest ? *j.rest : a.orientation.conjugate() * b.orientation);
  if (j.frame) {
    const Quaternion rest = out.rest();
    out.frame_a = j.frame->normalized();
    out.frame_b = (rest.conjugate() * out.frame_a).normalized();
  }
  return out;
}

}  // namespace

void require(bool holds, const char* quantity, double value, const char* bound) {
  if (holds) return;
  std::ostringstream text;
  text << quantity << " is " << value << "; must be " << bound;
  throw SceneError(text.str());
}

bool Joint::is_kinked() const {
  const Quaternion one = Quaternion::Identity();
  return frame_a.coeffs() != one.coeffs() || frame_b.coeffs() != one.coeffs();
}

void set_rest(Joint& joint, const Quaternion& rest) {
  constexpr double rounding = 1e-14;  // of equal orientations
  Quaternion half = rest.normalized();
  if (half.w() < 0) half.coeffs() = -half.coeffs();
  if (half.vec().norm() < rounding) half = Quaternion::Identity();
  half.w() += 1;
  joint.frame_a = half.normalized();
  joint.frame_b = joint.frame_a.conjugate();
}

Rod::Rod(const std::vector<SegmentSpec>& segment_specs, const std::vector<JointSpec>& joint_specs) {
  if (segment_specs.empty()) throw SceneError("a rod needs at least one segment");
  int index = 0;
  for (const SegmentSpec& s : segment_specs) {
    segments.push_back(make_segment(s, index++));
    position.push_back(s.position_m);
    orientation.push_back(s.orientation.normalized());
  }
  index = 0;
  for (const JointSpec& j : joint_specs) joints.push_back(make_joint(j, segment_specs, index++));
  velocity.assign(segments.size(), Vector3::Zero());
  angular_velocity.assign(segments.size(), Vector3::Zero());
  lambda = VectorX::Zero(6 * joint_count());
  free_position = position;
  free_orientation = orientation;
}

void refuse_static_joints(const Rod& rod) {
  for (int k = 0; k < rod.joint_count(); ++k) {
    const Joint& joint = rod.joints[static_cast<std::size_t>(k)];
    if (rod.segments[static_cast<std::size_t>(joint.a)].is_static &&
        rod.segments[static_cast<std::size_t>(joint.b)].is_static)
      throw SceneError("joint " + std::to_string(k) + " joins two static segments; remove it or free one of them");
  }
}

Section elliptic_section(double half_axis_x_m, double half_axis_y_m, double youngs_modulus_pa,
                         double torsion_modulus_pa) {
  const double a = half_axis_x_m, b = half_axis_y_m, a2 = a * a, b2 = b * b, area = pi * a * b;
  return {youngs_modulus_pa * area * b2 / 4, youngs_modulus_pa * area * a2 / 4,
          torsion_modulus_pa * area * a2 * b2 / (a2 + b2), youngs_modulus_pa * area,
          shear_coefficient(youngs_modulus_pa, torsion_modulus_pa) * torsion_modulus_pa * area};
}

Section circular_section(double radius_m, double youngs_modulus_pa, double torsion_modulus_pa) {
  const double r4 = radius_m * radius_m * radius_m * radius_m, area = pi * radius_m * radius_m;
  return {youngs_modulus_pa * pi * r4 / 4, youngs_modulus_pa * pi * r4 / 4, torsion_modulus_pa * pi * r4 / 2,
          youngs_modulus_pa * area,
          shear_coefficient(youngs_modulus_pa, torsion_modulus_pa) * torsion_modulus_pa * area};
}

double shear_coefficient(double youngs_modulus_pa, double torsion_modulus_pa) {
  const double nu = std::clamp(youngs_modulus_pa / (2 * torsion_modulus_pa) - 1, 0.0, 0.5);
  return (6 + 12 * nu + 6 * nu * nu) / (7 + 12 * nu + 4 * nu * nu);
}

Vector6 joint_compliance(double length_m, const Section& section, double stretch_per_j) {
  Vector6 alpha;
  alpha << stretch_per_j, stretch_per_j, stretch_per_j, length_m / section.bending_x_nm2,
      length_m / section.bending_y_nm2, length_m / section.torsion_nm2;
  return alpha;
}

Vector6 joint_compliance(double length_m, double radius_m, double youngs_modulus_pa, double torsion_modulus_pa,
                         double stretch_per_j) {
  return joint_compliance(length_m, circular_section(radius_m, youngs_modulus_pa, torsion_modulus_pa), stretch_per_j);
}

Vector6 physical_compliance(double length_m, const Section& section) {
  Vector6 alpha = joint_compliance(length_m, section, 1 / (section.shear_n * length_m));
  alpha[2] = 1 / (section.axial_n * length_m);
  return alpha;
}

double inextensible_compliance(double joint_length_m, double force_n) { return 1e-7 / (joint_length_m * force_n); }

}  // namespace rodsweep
