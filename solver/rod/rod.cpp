#include "solver/rod/rod.hpp"

#include <cmath>
#include <sstream>
#include <string>

#include "solver/numbers/rotation.hpp"

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
  const CrossSection section = s.cross_section();
  out.mass = s.mass();
  out.inertia_axial = s.density_kg_m3 * s.length_m * (section.second_moment_x_m4 + section.second_moment_y_m4);
  out.inertia_transverse = out.mass * s.length_m * s.length_m / 12 + out.inertia_axial / 2;
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
  const SegmentSpec &a = segments[at(j.a)], &b = segments[at(j.b)];
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
  joint.frame_a = joint.frame_b = Quaternion::Identity();
  Quaternion d0 = rest.normalized();
  if (d0.w() < 0) d0.coeffs() = -d0.coeffs();
  if (d0.vec().norm() < rounding) return;
  const auto half = [](Quaternion turn) {
    if (turn.w() < 0) turn.coeffs() = -turn.coeffs();
    turn.w() += 1;
    return turn.normalized();
  };
  const Quaternion swing = turn_between(Vector3::UnitZ(), d0 * Vector3::UnitZ());
  joint.frame_a = half(swing) * half(swing.conjugate() * d0);
  joint.frame_b = (d0.conjugate() * joint.frame_a).normalized();
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

Vector6 Rod::outer_impulse(std::size_t segment) const {
  Vector6 out = contact_impulse.empty() ? Vector6::Zero() : contact_impulse[segment];
  if (!load_torque_nm.empty()) out.tail<3>() += constraint_dt * constraint_dt * load_torque_nm[segment];
  return out;
}

std::vector<std::vector<JointEnd>> joints_by_segment(const Rod& rod) {
  std::vector<std::vector<JointEnd>> out(rod.segments.size());
  for (int k = 0; k < rod.joint_count(); ++k) {
    out[at(rod.joints[at(k)].a)].push_back({k, false});
    out[at(rod.joints[at(k)].b)].push_back({k, true});
  }
  return out;
}

void refuse_static_joints(const Rod& rod) {
  for (int k = 0; k < rod.joint_count(); ++k) {
    const Joint& joint = rod.joints[at(k)];
    if (rod.segments[at(joint.a)].is_static && rod.segments[at(joint.b)].is_static)
      throw SceneError("joint " + std::to_string(k) + " joins two static segments; remove it or free one of them");
  }
}

}  // namespace rodsweep
