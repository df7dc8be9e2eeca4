#include <cmath>
#include <string>

#include "solver/numbers/rotation.hpp"
#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

Quaternion about_rod(double angle) { return Quaternion(Eigen::AngleAxisd(angle, Vector3::UnitZ())); }

}  // namespace

void Ring::check() const {
  check_least("segments", segments, 3, ": fewer do not close a ring");
  if (clamp == Clamp::wall) throw SceneError("a ring has no end that the clamp \"wall\" could hold");
  if (!(std::abs(twist_deg) <= 90.0 * segments))
    throw SceneError("twist_deg is " + std::to_string(twist_deg) + "; must be at most 90 degrees for each of " +
                     std::to_string(segments) + " segments");
  const CrossSection of = cross_section(*this);
  if (twist_deg != 0 && of.second_moment_x_m4 != of.second_moment_y_m4)
    throw SceneError(
        "twist_deg is " + std::to_string(twist_deg) +
        "; must be 0 for a \"section\" that bends more easily about one axis than about the other, or the section "
        "must be a circle or a tube");
}

SceneSize Ring::size() const { return {segments, segments}; }

// The frames are those of the untwisted polygon, in which all joints bend equally. The twist is in the rest shape: the
// material of segment i is rotated back by i times the twist of a joint relative to its frame. So the rest rotation of
// a joint stays small, also where the ends were joined. For a circular cross-section that is the same rod.
void Ring::build(Scene& scene) const {
  const double side = length_m / segments, turn = 2 * pi / segments, twist = twist_deg * pi / 180 / segments;
  const Quaternion top = turn_between(Vector3::UnitZ(), Vector3::UnitX());
  const double apothem = side / 2 / std::tan(turn / 2);
  std::vector<SegmentSpec> rod;
  for (int i = 0; i < segments; ++i) {
    const Quaternion about_centre(Eigen::AngleAxisd(-i * turn, Vector3::UnitZ()));
    const Vector3 centre = about_centre * Vector3(0, apothem, 0) - Vector3(0, apothem, 0);
    rod.push_back(segment_at(centre, (about_centre * top).normalized(), side, *this));
  }
  rod.front().is_static = clamp == Clamp::segment;

  const double force = weight(rod, *this) + stiffness(*this).bending_x_nm2 / (apothem * apothem);
  std::vector<JointSpec> joints;
  for (int i = 0; i < segments; ++i) {
    const int next = (i + 1) % segments;
    JointSpec joint = joint_between(rod, i, next, *this, force);
    const Quaternion circular = rod[at(i)].orientation.conjugate() * rod[at(next)].orientation;
    const bool straight = rest_shape == Ring::RestShape::straight;
    joint.rest = (about_rod(i * twist) * (straight ? Quaternion::Identity() : circular) * about_rod(-(i + 1) * twist))
                     .normalized();
    joints.push_back(joint);
  }
  scene.rods.emplace_back(rod, joints);
}

}  // namespace rodsweep
