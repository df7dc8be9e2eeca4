#include <cmath>
#include <string>

#include "solver/numbers/rotation.hpp"
#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

Quaternion about_rod(double angle) { return Quaternion(Eigen::AngleAxisd(angle, Vector3::UnitZ())); }

constexpr double open_ring_radii = 40;  // circumference of the smallest ring through which the next fits

void displace(Rod& rod, const Quaternion& turn, const Vector3& shift) {
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    rod.position[s] = turn * rod.position[s] + shift;
    rod.orientation[s] = (turn * rod.orientation[s]).normalized();
  }
}

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

void RingChain::check() const {
  check_least("rings", rings, 1);
  check_least("segments", segments, 8, ": fewer do not make a round ring");
  const double shortest = open_ring_radii * radius_m;
  if (!(length_m >= shortest))
    throw SceneError("length_m is " + std::to_string(length_m) + "; must be at least " + std::to_string(shortest) +
                     " for rings of this radius_m to hang through each other");
  check_segments("a chain", static_cast<double>(rings) * segments);
}

SceneSize RingChain::size() const { return {rings * segments, rings * segments, rings, "rings"}; }

void RingChain::build(Scene& scene) const {
  Ring ring;
  static_cast<RodParameters&>(ring) = *this;
  ring.segments = segments;
  ring.length_m = length_m;
  ring.rest_shape = Ring::RestShape::circle;
  // From the top of a ring to that of the next: the inner diameter minus the next ring's thickness. The diameter is
  // twice the apothem, because rings hang from the middle of a side; a tenth of a radius remains free.
  const double drop = length_m / segments / std::tan(pi / segments) - 2.1 * radius_m;
  for (int k = 0; k < rings; ++k) {
    ring.clamp = k == 0 ? Clamp::segment : Clamp::free;
    ring.build(scene);
    const Quaternion turn(Eigen::AngleAxisd(k % 2 * pi / 2, Vector3::UnitY()));
    displace(scene.rods.back(), turn, Vector3(0, -k * drop, 0));
  }
}

}  // namespace rodsweep
